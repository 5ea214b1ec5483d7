#include "underbrush/test_site/foliage.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::test_site {
namespace {

int sides_for(double radius_m) {
  if (radius_m > 0.06) return 12;
  if (radius_m > 0.02) return 7;
  return radius_m > 0.006 ? 4 : 3;
}

struct Leaf {
  Vec3 base, axis, normal;
  double length_m;
};

Leaf draw_leaf(const Vec3& at, const Vec3& twig, double roll, const Foliage& foliage,
               Stream& random) {
  const Vec3 across = twig.unitOrthogonal();
  const Vec3 away = std::cos(roll) * across + std::sin(roll) * twig.cross(across);
  const Vec3 stalk = (away + 0.6 * twig).normalized();
  const double zenith = leaf_angle_quantile(foliage.angles, random.uniform());
  const double azimuth = random.uniform(0, 2 * M_PI);
  const Vec3 normal(std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
                    std::cos(zenith));
  Vec3 axis = stalk - stalk.dot(normal) * normal;
  axis = axis.norm() > 0.05 ? axis.normalized() : normal.unitOrthogonal();
  return {at + foliage.petiole_m * stalk, axis, normal,
          foliage.leaf_length_m * random.uniform(0.8, 1.2)};
}

}  // namespace

void add_wood(PlantMesh& plant, const Skeleton& skeleton, const std::vector<double>& radii) {
  const size_t n = skeleton.size();
  // The thickest child continues the branch; the others start branches of their own.
  std::vector<int32_t> main_child(n, -1), children(n, 0);
  for (size_t i = 0; i < n; ++i) {
    if (skeleton.parent[i] < 0) continue;
    const auto p = size_t(skeleton.parent[i]);
    ++children[p];
    if (main_child[p] < 0 || radii[i] > radii[size_t(main_child[p])]) main_child[p] = int32_t(i);
  }
  std::vector<TubePoint> axis;
  for (size_t i = 0; i < n; ++i) {
    const int32_t p = skeleton.parent[i];
    if (p >= 0 ? main_child[size_t(p)] == int32_t(i) : main_child[i] < 0) continue;
    axis.clear();
    if (p >= 0) axis.push_back({skeleton.position[size_t(p)], radii[i]});
    bool left_out = false;
    for (auto k = int32_t(i); k >= 0; k = main_child[size_t(k)]) {
      const auto at = size_t(k);
      // In a thin unbranched twig every other node is left out, which saves triangles and keeps the
      // shape.
      left_out = !left_out && !axis.empty() && children[at] == 1 && radii[at] < 0.006;
      if (!left_out) axis.push_back({skeleton.position[at], radii[at]});
    }
    add_tube(plant, axis, sides_for(axis.front().radius_m));
  }
}

void add_leaves(PlantMesh& plant, const Skeleton& skeleton, const std::vector<bool>& leafy,
                const Foliage& foliage, Stream& random) {
  const double leaf_area = 0.5 * foliage.leaf_length_m * foliage.leaf_width_m;
  require(leaf_area > 0 && foliage.area_m2 >= 0, "foliage: sizes must be positive");
  double total_m = 0;
  for (size_t i = 0; i < skeleton.size(); ++i) {
    if (leafy[i]) total_m += skeleton.segment(i).norm();
  }
  const auto count = size_t(std::lround(foliage.area_m2 / leaf_area));
  if (count == 0 || total_m == 0) return;

  std::vector<Leaf> leaves;
  leaves.reserve(count);
  const double spacing_m = total_m / double(count);
  double begin_m = 0, squares = 0;
  for (size_t i = 0; i < skeleton.size(); ++i) {
    if (!leafy[i]) continue;
    const Vec3 segment = skeleton.segment(i);
    const double length_m = segment.norm();
    while (leaves.size() < count) {
      const double at_m = (double(leaves.size()) + 0.5) * spacing_m - begin_m;
      if (at_m > length_m) break;
      const Vec3 at = skeleton.position[i] + (at_m / length_m - 1) * segment;
      const double roll = kGoldenAngle * double(leaves.size()) + random.uniform(-0.4, 0.4);
      leaves.push_back(draw_leaf(at, segment / length_m, roll, foliage, random));
      squares += leaves.back().length_m * leaves.back().length_m;
    }
    begin_m += length_m;
  }
  const double aspect = foliage.leaf_width_m / foliage.leaf_length_m;
  const double scale = std::sqrt(foliage.area_m2 / (0.5 * aspect * squares));
  plant.mesh.vertices.reserve(plant.mesh.vertices.size() + 4 * leaves.size());
  for (const Leaf& leaf : leaves) {
    const double length_m = scale * leaf.length_m;
    add_leaf(plant, leaf.base, leaf.axis, leaf.normal, length_m, aspect * length_m);
  }
}

}  // namespace underbrush::test_site
