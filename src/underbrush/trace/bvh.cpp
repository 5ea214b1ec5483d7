#include "underbrush/trace/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/triangle_pairs.hpp"

namespace underbrush::trace {
namespace {

// Widens a box by the rounding of the float box test at the box's largest coordinate.
Box widened(Box b) {
  for (int d = 0; d < 3; ++d) {
    const float margin = 1e-6f * std::max(std::abs(b.lo[d]), std::abs(b.hi[d])) + 1e-6f;
    b.lo[d] -= margin;
    b.hi[d] += margin;
  }
  return b;
}

Box ellipsoid_box(const elements::Ellipsoid& e, double tau) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    constexpr size_t kDiagonal[3] = {0, 3, 5};
    const double half = 1.00001 * tau * std::sqrt(double(e.covariance[kDiagonal[d]]));
    box.lo[d] = float(e.mean[d] - half);
    box.hi[d] = float(e.mean[d] + half);
  }
  return widened(box);
}

/// An upper triangular U with UᵀU = (τ²Σ)⁻¹, in the order u00 u01 u02 u11 u12 u22. It is the
/// inverse of R in τ²Σ = R Rᵀ, a Cholesky factor that is computed from the last row upwards.
struct Factor {
  double u[6];
  /// An upper bound on the ratio of the largest to the smallest extent, ‖U‖ ‖R‖.
  double condition;
};

Factor factor_of(const elements::Ellipsoid& e, double tau, double inflate_m2) {
  const auto& c = e.covariance;
  const double k = tau * tau;
  const double r22 = std::sqrt(k * c[5] + inflate_m2);
  const double r12 = k * c[4] / r22, r02 = k * c[2] / r22;
  const double r11 = std::sqrt(k * c[3] + inflate_m2 - r12 * r12);
  const double r01 = (k * c[1] - r02 * r12) / r11;
  const double r00 = std::sqrt(k * c[0] + inflate_m2 - r02 * r02 - r01 * r01);
  Factor f;
  f.u[0] = 1 / r00;
  f.u[3] = 1 / r11;
  f.u[5] = 1 / r22;
  f.u[1] = -r01 * f.u[3] * f.u[0];
  f.u[4] = -r12 * f.u[5] * f.u[3];
  f.u[2] = -(r01 * f.u[4] + r02 * f.u[5]) * f.u[0];
  double norm = 0;
  for (double u : f.u) norm += u * u;
  f.condition = std::sqrt(norm * k * (double(c[0]) + c[3] + c[5]));
  return f;
}

constexpr double kThin = 1e4;  // beyond this condition floats cannot decide

LeafKind kind_of(const elements::Model& model, const elements::Ellipsoid& e) {
  if (model.voxel_m > 0 || !(factor_of(e, model.tau, 0).condition < kThin)) {
    return LeafKind::kCareful;
  }
  return e.density_per_m > 0 ? LeafKind::kPathLength : LeafKind::kEllipsoids;
}

uint32_t block_threshold(double p) {
  const AcceptThreshold t = accept_threshold(p);
  return t.always ? kAlways : std::min(t.below, kAlways - 1);
}

/// Computes an upper bound on the hit probability of any beam through the ellipsoid.
double largest_p(const elements::Ellipsoid& e) {
  if (e.density_per_m <= 0) return e.hit.p;
  const double sigma = std::sqrt(double(e.covariance[0]) + e.covariance[3] + e.covariance[5]);
  return 1.0001 * -std::expm1(-double(e.density_per_m) * std::sqrt(2 * M_PI) * sigma);
}

template <class Block>
Block block_of_nothing() {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Block block{};
  if constexpr (std::is_same_v<Block, EllipsoidBlock>) {
    std::fill_n(&block.element[0], kWidth, Intersection::kNone);
    std::fill_n(&block.mean[0][0], 3 * kWidth, kNan);
  } else {
    std::fill_n(&block.element[0][0], 2 * kWidth, Intersection::kNone);
    std::fill_n(&block.corner[0][0][0], 12 * kWidth, kNan);
  }
  return block;
}

EllipsoidBlock ellipsoid_block(const elements::Model& model, const Ref* refs, uint32_t count,
                               LeafKind kind) {
  EllipsoidBlock block = block_of_nothing<EllipsoidBlock>();
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t id = refs[k].id();
    const elements::Ellipsoid& e = model.ellipsoids[model.place_at(id).index];
    // Thin shapes are thickened, so that their float tests stay meaningful and err towards finding
    // them.
    const double size2 = double(e.covariance[0]) + e.covariance[3] + e.covariance[5];
    const double inflate =
        kind == LeafKind::kCareful ? size2 * model.tau * model.tau / (0.25 * kThin * kThin) : 0;
    const Factor f = factor_of(e, model.tau, inflate);
    for (int c = 0; c < 6; ++c) block.u[c][k] = float(f.u[c]);
    for (int d = 0; d < 3; ++d) block.mean[d][k] = e.mean[d];
    block.element[k] = model.number_at(id) | uint32_t(model.grain.place_of(e.label)) << kGrainShift;
    if (kind == LeafKind::kPathLength) {
      block.depth[k] = float(double(e.density_per_m) * std::sqrt(2 * M_PI) / model.tau);
    } else {
      block.accept_below[k] = block_threshold(largest_p(e));
    }
  }
  return block;
}

/// Writes one of the triangles of lane k. Corner `apart` is the one that the other does not have.
void set_triangle(const elements::TriangleMesh& mesh, size_t at, uint32_t number, size_t which,
                  uint32_t apart, uint32_t k, TriangleBlock& block) {
  for (size_t v = 0; v < 3; ++v) {
    const Vec3f& corner = mesh.vertices[mesh.triangles[at][v]];
    for (int d = 0; d < 3; ++d) block.corner[kTurns[which][apart][v]][d][k] = corner[d];
  }
  block.element[which][k] = number | apart << kTurnShift;
  block.accept_below[which][k] = block_threshold(mesh.hit[at].p);
}

TriangleBlock triangle_block(const elements::Model& model, const TrianglePairs& pairs,
                             const Ref* refs, uint32_t count) {
  TriangleBlock block = block_of_nothing<TriangleBlock>();
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t id = refs[k].id();
    const elements::ElementPlace place = model.place_at(id);
    const elements::TriangleMesh& mesh = model.mesh(place.kind);
    const TrianglePair pair = pairs[id];
    set_triangle(mesh, place.index, model.number_at(id), 0, pair.apart, k, block);
    if (pair.other != Intersection::kNone) {
      const uint32_t other = model.place_at(pair.other).index;
      set_triangle(mesh, other, model.number_at(pair.other), 1, pair.other_apart, k, block);
    } else {
      for (int d = 0; d < 3; ++d) block.corner[3][d][k] = block.corner[2][d][k];
    }
  }
  return block;
}

HugeVector<Ref> refs_of(const elements::Model& model, const TrianglePairs& pairs) {
  const std::vector<uint32_t>& first = pairs.first();
  HugeVector<Ref> refs(first.size() + model.ellipsoids.size());
  parallel_for(refs.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (i < first.size()) {
        const elements::ElementPlace place = model.place_at(first[i]);
        const elements::TriangleMesh& mesh = model.mesh(place.kind);
        Box box = triangle_box(mesh, place.index);
        if (const uint32_t other = pairs[first[i]].other; other != Intersection::kNone) {
          box.add(triangle_box(mesh, model.place_at(other).index));
        }
        refs[i] = Ref(widened(box), first[i], uint32_t(LeafKind::kTriangles));
      } else {
        const size_t at = i - first.size();
        const elements::Ellipsoid& e = model.ellipsoids[at];
        refs[i] = Ref(ellipsoid_box(e, model.tau), uint32_t(model.triangle_count() + at),
                      uint32_t(kind_of(model, e)));
      }
    }
  });
  return refs;
}

constexpr size_t kAhead = 4;  // leaves whose elements are prefetched

// Prefetches the elements of a leaf, which lie far apart in memory.
void prefetch_elements(const elements::Model& model, const HugeVector<Ref>& refs,
                       const Leaf& leaf) {
  for (uint32_t k = 0; k < leaf.count; ++k) {
    const elements::ElementPlace place = model.place_at(refs[leaf.begin + k].id());
    if (place.kind != elements::Kind::kEllipsoid) continue;
    const char* e = reinterpret_cast<const char*>(&model.ellipsoids[place.index]);
    __builtin_prefetch(e);
    __builtin_prefetch(e + sizeof(elements::Ellipsoid) - 1);
  }
}

}  // namespace

size_t Bvh::bytes() const {
  return nodes.size() * sizeof(Node) + ellipsoids.size() * sizeof(EllipsoidBlock) +
         triangles.size() * sizeof(TriangleBlock);
}

Bvh build_bvh(const elements::Model& model) {
  const TrianglePairs pairs(model);
  HugeVector<Ref> refs = refs_of(model, pairs);
  Hierarchy tree = build_hierarchy(refs, kWidth);
  Bvh bvh;
  bvh.box = tree.box;
  // Leaves become blocks, which are numbered within each kind in the order of the tree.
  std::vector<uint32_t> reference(tree.leaves.size());
  uint32_t ellipsoids = 0, triangles = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    const LeafKind kind = LeafKind(refs[tree.leaves[i].begin].kind());
    reference[i] = leaf_reference(kind, kind == LeafKind::kTriangles ? triangles++ : ellipsoids++);
  }
  bvh.ellipsoids.resize(ellipsoids);
  bvh.triangles.resize(triangles);
  parallel_for(reference.size(), 512, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (i + kAhead < end) prefetch_elements(model, refs, tree.leaves[i + kAhead]);
      const Leaf leaf = tree.leaves[i];
      Ref* first = refs.data() + leaf.begin;
      std::sort(first, first + leaf.count,
                [](const Ref& a, const Ref& b) { return a.id() < b.id(); });
      const LeafKind kind = leaf_kind(reference[i]);
      const uint32_t index = reference[i] & kIndexMask;
      if (kind == LeafKind::kTriangles) {
        bvh.triangles[index] = triangle_block(model, pairs, first, leaf.count);
      } else {
        bvh.ellipsoids[index] = ellipsoid_block(model, first, leaf.count, kind);
      }
    }
  });
  const auto renamed = [&](uint32_t child) {
    return child != kEmpty && child & kLeaf ? reference[child & ~kLeaf] : child;
  };
  bvh.root = renamed(tree.root);
  parallel_for(tree.nodes.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Node& node = tree.nodes[i];
      for (int k = 0; k < kWidth; ++k) {
        if (node.lo[0][k] <= node.hi[0][k]) node.child[k] = renamed(node.child[k]);
      }
    }
  });
  bvh.nodes = std::move(tree.nodes);
  return bvh;
}

}  // namespace underbrush::trace
