#include "underbrush/test_site/tree.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/test_site/crown.hpp"

namespace underbrush::test_site {
namespace {

constexpr double kTwigRadius = 0.0022;  // m

Vec3 direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

// Adds a trunk that leans and wavers a little. Returns the indices of its nodes from the foot to
// the top.
std::vector<int32_t> add_trunk(Skeleton& skeleton, double height_m, double step_m, double waver,
                               Stream& random) {
  std::vector<int32_t> trunk = {skeleton.add(Vec3::Zero(), -1)};
  const double a = random.uniform(0, 2 * M_PI), b = random.uniform(0, 2 * M_PI);
  const double length_a = height_m * random.uniform(0.5, 0.9);
  const double length_b = height_m * random.uniform(0.2, 0.4);
  const int steps = std::max(2, int(std::lround(height_m / step_m)));
  for (int i = 1; i <= steps; ++i) {
    const double z = height_m * i / steps;
    const double x = waver * height_m * (std::sin(2 * M_PI * z / length_a + a) - std::sin(a));
    const double y = 0.4 * waver * height_m * (std::sin(2 * M_PI * z / length_b + b) - std::sin(b));
    trunk.push_back(skeleton.add({x, y, z}, trunk.back()));
  }
  return trunk;
}

Skeleton broadleaf(const TreeParameters& p, Stream& random) {
  const Crown crown{p.crown_base_m, p.height_m, p.crown_radius_m, 0.42};
  const double crown_m = p.height_m - p.crown_base_m;
  Skeleton skeleton;
  GrowthOptions growth;
  growth.step_m = 0.6 * p.twig_spacing_m;
  growth.reached_m = 0.9 * p.twig_spacing_m;
  const std::vector<int32_t> trunk =
      add_trunk(skeleton, p.crown_base_m + 0.55 * crown_m, growth.step_m, 0.012, random);
  const int limbs = 7 + int(random.below(4));
  double azimuth = random.uniform(0, 2 * M_PI);
  for (int i = 0; i < limbs; ++i) {
    // Fraction of the way up from the crown's base.
    const double up = (i + random.uniform(0, 0.7)) / limbs;
    const double z = p.crown_base_m + 0.55 * up * crown_m;
    const size_t k =
        size_t(z / skeleton.position[size_t(trunk.back())].z() * double(trunk.size() - 1));
    azimuth += kGoldenAngle + random.uniform(-0.3, 0.3);
    const double elevation = 0.35 + 0.75 * up + random.uniform(-0.12, 0.12);
    const double length_m = 0.62 * p.crown_radius_m * random.uniform(0.75, 1.1);
    add_limb(skeleton, trunk[std::min(k, trunk.size() - 1)], direction(azimuth, elevation),
             length_m, growth.step_m, 0.25 / p.crown_radius_m);
  }
  grow_into(skeleton, crown_markers(crown, p.twig_spacing_m, random), growth);
  add_side_shoots(skeleton, twigs(skeleton, 3), 0.55 * p.twig_spacing_m, random);
  return skeleton;
}

// Adds side twigs to one branch of a conifer, alternating left and right.
void add_side_twigs(Skeleton& skeleton, int32_t tip, int32_t foot, double length_m, double step_m,
                    Stream& random) {
  std::vector<int32_t> nodes;
  for (int32_t k = tip; k != foot; k = skeleton.parent[size_t(k)]) nodes.push_back(k);
  std::reverse(nodes.begin(), nodes.end());
  for (size_t i = 0; i + 1 < nodes.size(); ++i) {
    const double s = double(i + 1) / double(nodes.size());
    if (s < 0.12) continue;
    const Vec3 along = skeleton.segment(size_t(nodes[i])).normalized();
    Vec3 side = Vec3::UnitZ().cross(along).normalized();
    if (i % 2) side = -side;
    const double reach = 0.55 * length_m * (1.05 - s) * random.uniform(0.75, 1.1) + 0.6 * step_m;
    const double droop = random.uniform(-0.35, 0);
    add_limb(skeleton, nodes[i], (0.65 * along + 0.75 * side + droop * Vec3::UnitZ()).normalized(),
             reach, step_m, -0.1);
  }
}

Skeleton conifer(const TreeParameters& p, Stream& random) {
  const double step_m = 0.4 * p.twig_spacing_m;
  Skeleton skeleton;
  const std::vector<int32_t> trunk = add_trunk(skeleton, p.height_m, step_m, 0.003, random);
  const double crown_m = p.height_m - p.crown_base_m;
  const double whorl_m = std::clamp(0.03 * p.height_m, 0.18, 0.35);
  double azimuth = random.uniform(0, 2 * M_PI);
  for (double z = p.crown_base_m; z < p.height_m - 0.15; z += whorl_m * random.uniform(0.8, 1.2)) {
    const double up = (z - p.crown_base_m) / crown_m;
    const int branches = 5 + int(random.below(3));
    azimuth += kGoldenAngle;
    for (int i = 0; i < branches; ++i) {
      const double turn = azimuth + 2 * M_PI * i / branches + random.uniform(-0.25, 0.25);
      const double from_m = z + 0.5 * whorl_m * random.uniform(-1, 1);
      const double elevation = -0.22 + 0.87 * up + random.uniform(-0.18, 0.18);
      const double length_m =
          (p.crown_radius_m * std::pow(1 - up, 0.85) * random.uniform(0.75, 1.05) + 0.1) /
          std::cos(elevation);
      const auto k = size_t(from_m / p.height_m * double(trunk.size() - 1));
      const int32_t foot = trunk[std::clamp<size_t>(k, 1, trunk.size() - 1)];
      const int32_t tip = add_limb(skeleton, foot, direction(turn, elevation), length_m, step_m,
                                   (0.22 - 0.2 * up) / p.crown_radius_m);
      add_side_twigs(skeleton, tip, foot, length_m, step_m, random);
    }
  }
  return skeleton;
}

// Tells which segments bear leaves: the outer twigs, and on a conifer all but the stem and the
// shaded inner part.
std::vector<bool> leafy_segments(const TreeParameters& p, const Skeleton& skeleton) {
  std::vector<bool> leafy = twigs(skeleton, 8);
  for (size_t i = 0; p.species == Species::kConifer && i < skeleton.size(); ++i) {
    const double up = (skeleton.position[i].z() - p.crown_base_m) / (p.height_m - p.crown_base_m);
    const double out = skeleton.position[i].head<2>().norm() / p.crown_radius_m;
    leafy[i] = leafy[i] && out > 0.25 * (1 - up);
  }
  return leafy;
}

}  // namespace

TreeParameters typical_tree(Species species, double height_m, double lai) {
  TreeParameters p;
  p.species = species;
  p.height_m = height_m;
  const bool broad = species == Species::kBroadleaf;
  p.crown_radius_m = broad ? 0.9 + 0.165 * height_m : 0.55 + 0.105 * height_m;
  p.crown_base_m = (broad ? 0.2 : 0.11) * height_m;
  p.trunk_radius_m = 0.014 * height_m;
  p.twig_spacing_m = broad ? 0.13 + 0.0135 * height_m : 0.3;
  p.foliage.area_m2 = (broad ? 1 : 1.4) * lai * M_PI * p.crown_radius_m * p.crown_radius_m;
  if (!broad) {
    p.foliage.leaf_length_m = 0.11;
    p.foliage.leaf_width_m = 0.03;
    p.foliage.petiole_m = 0;
  }
  return p;
}

Skeleton tree_skeleton(const TreeParameters& p, Stream& random) {
  require(p.height_m > 0.5 && p.crown_radius_m > 0.1 && p.trunk_radius_m > kTwigRadius &&
              p.twig_spacing_m >= 0.02,
          "tree: impossible size");
  require(p.crown_base_m > 0 && p.crown_base_m < 0.9 * p.height_m,
          "tree: the crown must begin between ground and top");
  Skeleton skeleton = p.species == Species::kBroadleaf ? broadleaf(p, random) : conifer(p, random);
  double top_m = 0;
  for (const Vec3& at : skeleton.position) top_m = std::max(top_m, at.z());
  const double stretch = (p.height_m - 0.5 * p.foliage.leaf_length_m) / top_m;
  for (Vec3& at : skeleton.position) at.z() *= stretch;
  return skeleton;
}

PlantMesh tree(const TreeParameters& p, uint64_t seed) {
  Stream random(seed);
  const Skeleton skeleton = tree_skeleton(p, random);
  const std::vector<uint32_t> tips = carried_tips(skeleton);
  std::vector<double> radii = pipe_radii(tips, p.trunk_radius_m, kTwigRadius);
  for (size_t i = 0; i < radii.size(); ++i) {  // The bare stem tapers, and its foot flares.
    const double z = std::max(0.0, skeleton.position[i].z());
    const double flare = tips[i] == tips[0] ? 0.4 * std::exp(-z / 0.15) : 0;
    radii[i] =
        std::max(kTwigRadius, radii[i] * (1 - 0.2 * std::min(1.0, z / p.crown_base_m) + flare));
  }
  PlantMesh plant;
  add_wood(plant, skeleton, radii);
  add_leaves(plant, skeleton, leafy_segments(p, skeleton), p.foliage, random);
  return plant;
}

}  // namespace underbrush::test_site
