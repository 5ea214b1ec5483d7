#include "underbrush/test_site/shrub.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/test_site/crown.hpp"

namespace underbrush::test_site {
namespace {

constexpr double kTwigRadiusOfShrub = 0.0016;  // m

Skeleton grow(const ShrubParameters& p, Stream& random) {
  Skeleton skeleton;
  GrowthOptions growth;
  growth.step_m = 0.6 * p.twig_spacing_m;
  growth.reached_m = 0.9 * p.twig_spacing_m;
  const double turn = random.uniform(0, 2 * M_PI);
  for (int i = 0; i < p.stems; ++i) {
    const double azimuth = turn + kGoldenAngle * i;
    const double lean = 0.75 * std::sqrt((i + 0.5) / p.stems) + random.uniform(-0.1, 0.1);
    const Vec3 out(std::cos(azimuth), std::sin(azimuth), 0);
    const double tan_max = p.radius_m / p.height_m;
    const Vec3 along = (Vec3::UnitZ() + 1.2 * lean * tan_max * out).normalized();
    const int32_t root = skeleton.add(0.08 * p.radius_m * std::sqrt(double(i)) * out, -1);
    add_limb(skeleton, root, along, 0.6 * p.height_m * random.uniform(0.7, 1.1), growth.step_m,
             -0.15 * lean / p.height_m);
  }
  const Crown crown{0.06 * p.height_m, p.height_m, p.radius_m, 0.45, 0};
  grow_into(skeleton, crown_markers(crown, p.twig_spacing_m, random), growth);
  add_side_shoots(skeleton, twigs(skeleton, 3), 0.5 * p.twig_spacing_m, random);
  double top_m = 0;
  for (const Vec3& at : skeleton.position) top_m = std::max(top_m, at.z());
  const double stretch = (p.height_m - 0.5 * p.foliage.leaf_length_m) / top_m;
  for (Vec3& at : skeleton.position) at.z() *= stretch;
  return skeleton;
}

}  // namespace

ShrubParameters typical_shrub(double height_m, double lai) {
  ShrubParameters p;
  p.height_m = height_m;
  p.radius_m = 0.15 + 0.5 * height_m;
  p.stems = 5 + int(2 * height_m);
  p.stem_radius_m = 0.006 + 0.008 * height_m;
  p.twig_spacing_m = 0.06 + 0.045 * height_m;
  p.foliage.area_m2 = lai * M_PI * p.radius_m * p.radius_m;
  p.foliage.leaf_length_m = 0.047 + 0.013 * std::min(height_m, 2.0);
  p.foliage.leaf_width_m = 0.62 * p.foliage.leaf_length_m;
  return p;
}

PlantMesh shrub(const ShrubParameters& p, uint64_t seed) {
  require(p.height_m > 0.1 && p.radius_m > 0.05 && p.stems > 0 &&
              p.stem_radius_m > kTwigRadiusOfShrub && p.twig_spacing_m >= 0.01 &&
              p.foliage.leaf_length_m < p.height_m,
          "shrub: impossible size");
  Stream random(seed);
  const Skeleton skeleton = grow(p, random);
  PlantMesh plant;
  add_wood(plant, skeleton,
           pipe_radii(carried_tips(skeleton), p.stem_radius_m, kTwigRadiusOfShrub));
  add_leaves(plant, skeleton, twigs(skeleton, 8), p.foliage, random);
  return plant;
}

}  // namespace underbrush::test_site
