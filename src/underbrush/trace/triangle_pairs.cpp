#include "underbrush/trace/triangle_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace underbrush::trace {
namespace {

/// A side of a triangle, from one of its corners to the next.
struct Side {
  uint32_t triangle, to;
};

/// The sides of a mesh by the vertex from which they run. Where more than `kMany` begin, they are
/// in the order of their ends, so that the time does not grow with the square of their number.
class Sides {
 public:
  static constexpr size_t kMany = 32;

  explicit Sides(const elements::TriangleMesh& mesh)
      : begin_(mesh.vertices.size() + 1), side_(3 * mesh.size()) {
    for (const auto& corners : mesh.triangles) {
      for (const uint32_t v : corners) ++begin_[v];
    }
    uint32_t sum = 0;
    for (uint32_t& b : begin_) b = sum += b;
    for (size_t t = mesh.size(); t-- > 0;) {
      for (size_t k = 3; k-- > 0;) {
        side_[--begin_[mesh.triangles[t][k]]] = {uint32_t(t), mesh.triangles[t][(k + 1) % 3]};
      }
    }
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      const std::span<Side> sides = from(v);
      if (sides.size() > kMany) std::ranges::stable_sort(sides, {}, &Side::to);
    }
  }

  /// Calls visit(triangle) for each triangle with the side from `begin` to `end`; for the first
  /// ones alone where there are many.
  template <class Visit>
  void each(uint32_t begin, uint32_t end, Visit visit) {
    std::span<Side> sides = from(begin);
    if (sides.size() > kMany) {
      const auto first = std::ranges::lower_bound(sides, end, {}, &Side::to);
      const auto last = std::ranges::upper_bound(sides, end, {}, &Side::to);
      sides = {first, std::min(size_t(last - first), kMany)};
    }
    for (const Side& s : sides) {
      if (s.to == end) visit(s.triangle);
    }
  }

 private:
  std::span<Side> from(uint32_t vertex) {
    return std::span(side_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }

  std::vector<uint32_t> begin_;
  std::vector<Side> side_;
};

}  // namespace

Box triangle_box(const elements::TriangleMesh& mesh, size_t triangle) {
  Box box;
  for (const uint32_t v : mesh.triangles[triangle]) {
    const Vec3f& p = mesh.vertices[v];
    const Float4 at{p[0], p[1], p[2], 0};
    box.add(at, at);
  }
  return box;
}

TrianglePairs::TrianglePairs(const elements::Model& model) : pair_(model.triangle_count()) {
  first_.reserve(model.triangle_count());
  add(model.ground, 0);
  add(model.surface, uint32_t(model.ground.size()));
}

void TrianglePairs::add(const elements::TriangleMesh& mesh, uint32_t number) {
  Sides sides(mesh);
  std::vector<bool> taken(mesh.size());
  for (uint32_t t = 0; t < mesh.size(); ++t) {
    if (taken[t]) continue;
    const Box box = triangle_box(mesh, t);
    float least = INFINITY;
    TrianglePair pair;
    for (uint8_t k = 0; k < 3; ++k) {  // the side opposite of corner k
      const uint32_t from = mesh.triangles[t][(k + 1) % 3], to = mesh.triangles[t][(k + 2) % 3];
      sides.each(to, from, [&](uint32_t other) {
        if (other <= t || taken[other]) return;
        const Box of_other = triangle_box(mesh, other);
        Box both = box;
        both.add(of_other);
        const float area = both.area();
        if (area > box.area() + of_other.area() || area >= least) return;
        least = area;
        const auto& corners = mesh.triangles[other];
        uint8_t apart = 0;
        while (corners[(apart + 1) % 3] != to || corners[(apart + 2) % 3] != from) ++apart;
        pair = {number + other, k, apart};
      });
    }
    if (pair.other != Intersection::kNone) taken[pair.other - number] = true;
    pair_[number + t] = pair;
    first_.push_back(number + t);
  }
}

}  // namespace underbrush::trace
