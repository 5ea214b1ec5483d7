#include "underbrush/trace/bvh.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {
namespace {

using Array3f = Eigen::Array3f;

struct Box {
  Array3f lo = Array3f::Constant(INFINITY), hi = Array3f::Constant(-INFINITY);
  void add(const Box& b) {
    lo = lo.min(b.lo);
    hi = hi.max(b.hi);
  }
  void add(const Array3f& p) {
    lo = lo.min(p);
    hi = hi.max(p);
  }
  float area() const {
    const Array3f d = hi - lo;
    return d[0] >= 0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0;
  }
};

struct Ref {
  Box box;
  uint32_t element;
  bool triangle;
  Array3f centre2() const { return box.lo + box.hi; }
};

struct Range {
  uint32_t begin = 0, end = 0;
  Box box, centres;
  bool mixed = false;
  uint32_t size() const { return end - begin; }
};

// Boxes are widened by the rounding of the float box test at the scene's largest coordinate.
Box widened(const Box& b) {
  const Array3f margin = 1e-6f * b.lo.abs().max(b.hi.abs()) + 1e-6f;
  return {b.lo - margin, b.hi + margin};
}

Box triangle_box(const elements::TriangleMesh& mesh, size_t k) {
  Box box;
  for (uint32_t v : mesh.triangles[k]) box.add(mesh.vertices[v].array());
  return widened(box);
}

Box ellipsoid_box(const elements::Ellipsoid& e, double tau) {
  const Array3f half(float(tau * std::sqrt(double(e.covariance[0]))),
                     float(tau * std::sqrt(double(e.covariance[3]))),
                     float(tau * std::sqrt(double(e.covariance[5]))));
  Box box;
  box.add(e.mean.array() - 1.00001f * half);
  box.add(e.mean.array() + 1.00001f * half);
  return widened(box);
}

/// Grows one subtree into its own arrays, so that the layout does not depend on the threads.
class Builder {
 public:
  Builder(const elements::Model& model, std::vector<Ref>& refs) : model_(model), refs_(refs) {}

  Bvh build() {
    Range all;
    all.end = uint32_t(refs_.size());
    measure(all);
    Bvh out;
    if (all.size() == 0) return out;
    out.root = grow(all, out);
    return out;
  }

 private:
  static constexpr uint32_t kParallel = 8192;

  void measure(Range& r) const {
    r.box = r.centres = Box();
    r.mixed = false;
    for (uint32_t i = r.begin; i < r.end; ++i) {
      r.box.add(refs_[i].box);
      r.centres.add(refs_[i].centre2());
      r.mixed |= refs_[i].triangle != refs_[r.begin].triangle;
    }
  }

  bool is_leaf(const Range& r) const { return r.size() <= kWidth && !r.mixed; }

  // Splits where the surface-area heuristic, counted in blocks of eight, is least.
  void split(const Range& r, Range& a, Range& b) {
    uint32_t middle = r.begin + r.size() / 2;
    if (r.size() <= kWidth) {
      middle = uint32_t(std::stable_partition(refs_.begin() + r.begin, refs_.begin() + r.end,
                                              [](const Ref& x) { return !x.triangle; }) -
                        refs_.begin());
    } else {
      middle = binned_split(r);
    }
    a.begin = r.begin;
    a.end = b.begin = middle;
    b.end = r.end;
    measure(a);
    measure(b);
  }

  uint32_t binned_split(const Range& r) {
    constexpr int kBins = 16;
    Box box[3][kBins];
    uint32_t count[3][kBins] = {};
    const Array3f extent = r.centres.hi - r.centres.lo;
    Array3f scale;
    for (int d = 0; d < 3; ++d) scale[d] = extent[d] > 1e-20f ? kBins * 0.99999f / extent[d] : 0;
    const auto bin_of = [&](const Ref& ref, int d) {
      return std::clamp(int((ref.centre2()[d] - r.centres.lo[d]) * scale[d]), 0, kBins - 1);
    };
    for (uint32_t i = r.begin; i < r.end; ++i) {
      for (int d = 0; d < 3; ++d) {
        const int k = bin_of(refs_[i], d);
        box[d][k].add(refs_[i].box);
        ++count[d][k];
      }
    }
    float best = INFINITY;
    int axis = -1, cut = 0;
    for (int d = 0; d < 3; ++d) {
      if (scale[d] == 0) continue;
      float area[kBins];
      uint32_t n[kBins], sum = 0;
      Box right;
      for (int k = kBins - 1; k > 0; --k) {
        right.add(box[d][k]);
        area[k] = right.area();
        n[k] = sum += count[d][k];
      }
      Box left;
      sum = 0;
      for (int k = 1; k < kBins; ++k) {
        left.add(box[d][k - 1]);
        sum += count[d][k - 1];
        if (sum == 0 || n[k] == 0) continue;
        const float cost = left.area() * float((sum + 7) / 8) + area[k] * float((n[k] + 7) / 8);
        if (cost < best) {
          best = cost;
          axis = d;
          cut = k;
        }
      }
    }
    if (axis < 0) return r.begin + r.size() / 2;
    const auto at = std::partition(refs_.begin() + r.begin, refs_.begin() + r.end,
                                   [&](const Ref& ref) { return bin_of(ref, axis) < cut; });
    return uint32_t(at - refs_.begin());
  }

  uint32_t grow(const Range& range, Bvh& out) {
    if (is_leaf(range)) return emit(range, out);
    Range child[kWidth];
    int n = 1;
    child[0] = range;
    while (n < kWidth) {  // open the child of largest area until there are eight
      int open = -1;
      for (int k = 0; k < n; ++k) {
        if (!is_leaf(child[k]) && (open < 0 || child[k].box.area() > child[open].box.area())) {
          open = k;
        }
      }
      if (open < 0) break;
      Range a, b;
      split(child[open], a, b);
      child[open] = a;
      child[n++] = b;
    }
    const uint32_t me = uint32_t(out.nodes.size());
    out.nodes.emplace_back();
    uint32_t reference[kWidth];
    if (range.size() < kParallel) {
      for (int k = 0; k < n; ++k) reference[k] = grow(child[k], out);
    } else {
      std::vector<Bvh> part(n);
      parallel_for(size_t(n), 1, [&](size_t k, size_t) { part[k].root = grow(child[k], part[k]); });
      for (int k = 0; k < n; ++k) reference[k] = adopt(part[k], out);
    }
    Node& node = out.nodes[me];
    std::memset(node.unused, 0, sizeof(node.unused));
    for (int k = 0; k < kWidth; ++k) {
      for (int d = 0; d < 3; ++d) {
        node.lo[d][k] = k < n ? child[k].box.lo[d] : INFINITY;
        node.hi[d][k] = k < n ? child[k].box.hi[d] : -INFINITY;
      }
      node.child[k] = k < n ? reference[k] : kLeaf;
    }
    return me;
  }

  // Appends a subtree grown apart and returns its root's new reference.
  static uint32_t adopt(const Bvh& part, Bvh& out) {
    const uint32_t nodes = uint32_t(out.nodes.size()), ellipsoids = uint32_t(out.ellipsoids.size()),
                   triangles = uint32_t(out.triangles.size());
    const auto moved = [&](uint32_t ref) {
      if (!(ref & kLeaf)) return ref + nodes;
      return ref + (ref & kTriangles ? triangles : ellipsoids);
    };
    for (Node node : part.nodes) {
      for (uint32_t& c : node.child) c = moved(c);
      out.nodes.push_back(node);
    }
    out.ellipsoids.insert(out.ellipsoids.end(), part.ellipsoids.begin(), part.ellipsoids.end());
    out.triangles.insert(out.triangles.end(), part.triangles.begin(), part.triangles.end());
    return moved(part.root);
  }

  uint32_t emit(const Range& r, Bvh& out) {
    std::sort(refs_.begin() + r.begin, refs_.begin() + r.end,
              [](const Ref& x, const Ref& y) { return x.element < y.element; });
    return refs_[r.begin].triangle ? emit_triangles(r, out) : emit_ellipsoids(r, out);
  }

  uint32_t threshold(uint32_t element) const {
    const AcceptThreshold t = accept_threshold(model_.hit(element).p);
    return t.always ? 0xffffffffu : std::min(t.below, 0xfffffffeu);
  }

  uint32_t emit_triangles(const Range& r, Bvh& out) {
    TriangleBlock block{};
    for (uint32_t k = 0; k < r.size(); ++k) {
      const uint32_t id = refs_[r.begin + k].element;
      const bool ground = id < model_.ground.size();
      const elements::TriangleMesh& mesh = ground ? model_.ground : model_.surface;
      const auto& corners = mesh.triangles[ground ? id : id - model_.ground.size()];
      for (int v = 0; v < 3; ++v) {
        for (int d = 0; d < 3; ++d) block.corner[v][d][k] = mesh.vertices[corners[v]][d];
      }
      block.accept_below[k] = threshold(id);
      block.element[k] = id;
    }
    for (uint32_t k = r.size(); k < kWidth; ++k) {
      block.element[k] = Met::kNone;
      for (int v = 0; v < 3; ++v) {
        for (int d = 0; d < 3; ++d) block.corner[v][d][k] = NAN;
      }
    }
    out.triangles.push_back(block);
    return kLeaf | kTriangles | uint32_t(out.triangles.size() - 1);
  }

  uint32_t emit_ellipsoids(const Range& r, Bvh& out) {
    EllipsoidBlock block{};
    for (uint32_t k = 0; k < kWidth; ++k) {
      block.element[k] = Met::kNone;
      for (int d = 0; d < 3; ++d) block.mean[d][k] = NAN;
    }
    for (uint32_t k = 0; k < r.size(); ++k) {
      const uint32_t id = refs_[r.begin + k].element;
      const elements::Ellipsoid& e =
          model_.ellipsoids[id - model_.ground.size() - model_.surface.size()];
      const Mat3 inverse = (e.covariance_matrix() * (model_.tau * model_.tau)).inverse();
      const Mat3 u = Eigen::LLT<Mat3>(inverse).matrixU();
      const double values[6] = {u(0, 0), u(0, 1), u(0, 2), u(1, 1), u(1, 2), u(2, 2)};
      for (int c = 0; c < 6; ++c) block.u[c][k] = float(values[c]);
      for (int d = 0; d < 3; ++d) block.mean[d][k] = e.mean[d];
      block.accept_below[k] = threshold(id);
      block.element[k] = id;
    }
    out.ellipsoids.push_back(block);
    return kLeaf | uint32_t(out.ellipsoids.size() - 1);
  }

  const elements::Model& model_;
  std::vector<Ref>& refs_;
};

bool degenerate(const elements::TriangleMesh& mesh, size_t k) {
  const auto& t = mesh.triangles[k];
  const Vec3 a = mesh.vertices[t[0]].cast<double>();
  const Vec3 b = mesh.vertices[t[1]].cast<double>(), c = mesh.vertices[t[2]].cast<double>();
  return (b - a).cross(c - a).squaredNorm() == 0;
}

}  // namespace

size_t Bvh::bytes() const {
  return nodes.size() * sizeof(Node) + ellipsoids.size() * sizeof(EllipsoidBlock) +
         triangles.size() * sizeof(TriangleBlock);
}

Bvh build_bvh(const elements::Model& model) {
  const size_t triangles = model.ground.size() + model.surface.size();
  std::vector<Ref> refs(model.size());
  parallel_for(refs.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Ref& ref = refs[i];
      ref.element = uint32_t(i);
      ref.triangle = i < triangles;
      ref.box = i < model.ground.size() ? triangle_box(model.ground, i)
                : ref.triangle          ? triangle_box(model.surface, i - model.ground.size())
                                        : ellipsoid_box(model.ellipsoids[i - triangles], model.tau);
    }
  });
  // Elements that no beam can end at are left out of the hierarchy only where they have no extent.
  std::erase_if(refs, [&](const Ref& ref) {
    if (!ref.triangle) return false;
    const bool ground = ref.element < model.ground.size();
    return degenerate(ground ? model.ground : model.surface,
                      ground ? ref.element : ref.element - model.ground.size());
  });
  return Builder(model, refs).build();
}

}  // namespace underbrush::trace
