#include "underbrush/update/kept_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace underbrush::update {
namespace {

/// The corners seen from above, the least first.
struct Corners {
  std::array<std::array<float, 2>, 3> at;
  auto operator<=>(const Corners&) const = default;
};

/// The place in the triangle of the corner that comes first.
size_t first_corner(const elements::TriangleMesh& mesh, size_t triangle) {
  const auto place = [&](size_t k) {
    const Vec3f& v = mesh.vertices[mesh.triangles[triangle][k]];
    return std::array{v.x(), v.y()};
  };
  size_t first = 0;
  for (size_t k = 1; k < 3; ++k) {
    if (place(k) < place(first)) first = k;
  }
  return first;
}

const Vec3f& corner(const elements::TriangleMesh& mesh, size_t triangle, size_t first, size_t k) {
  return mesh.vertices[mesh.triangles[triangle][(first + k) % 3]];
}

Corners corners_of(const elements::TriangleMesh& mesh, size_t triangle) {
  const size_t first = first_corner(mesh, triangle);
  Corners out;
  for (size_t k = 0; k < 3; ++k) {
    const Vec3f& v = corner(mesh, triangle, first, k);
    out.at[k] = {v.x(), v.y()};
  }
  return out;
}

}  // namespace

std::vector<uint32_t> kept_triangles(const elements::TriangleMesh& before,
                                     const elements::TriangleMesh& now, float most_rise_m) {
  std::map<Corners, uint32_t> number;
  for (uint32_t t = 0; t < before.size(); ++t) number[corners_of(before, t)] = t;
  std::vector<uint32_t> out(now.size(), kNewTriangle);
  for (size_t t = 0; t < now.size(); ++t) {
    const auto at = number.find(corners_of(now, t));
    if (at == number.end()) continue;
    const size_t a = first_corner(now, t), b = first_corner(before, at->second);
    bool is_same = true;
    for (size_t k = 0; k < 3; ++k) {
      const float rise = corner(now, t, a, k).z() - corner(before, at->second, b, k).z();
      is_same = is_same && std::abs(rise) <= most_rise_m;
    }
    if (is_same) out[t] = at->second;
  }
  return out;
}

}  // namespace underbrush::update
