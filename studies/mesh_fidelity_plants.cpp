#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/mesh_fidelity.hpp"
#include "underbrush/pipeline/plants.hpp"
#include "underbrush/test_site/shrub.hpp"
#include "underbrush/test_site/tree.hpp"

namespace underbrush::studies {
namespace {

constexpr double kPlantVolumeM3 = 45;

/// Scales a plant to a box of 45 m³.
void scale(test_site::PlantMesh& plant) {
  const double factor = std::cbrt(kPlantVolumeM3 / test_site::bounds(plant.mesh).volume());
  for (Vec3f& v : plant.mesh.vertices) v *= float(factor);
}

/// Adds a flat picture of a tree, whose plane is turned by `turn_rad` from across the vehicle's
/// path.
void add_board(test_site::PlantMesh& out, double turn_rad) {
  const double half = std::sqrt(kPlantVolumeM3 / 5.5) / 2;
  const Vec3 side = half * Vec3(-std::sin(turn_rad), std::cos(turn_rad), 0), up(0, 0, 5.5);
  const uint32_t a = out.add_vertex(-side), b = out.add_vertex(side);
  const uint32_t c = out.add_vertex(side + up), d = out.add_vertex(up - side);
  out.add_triangle(a, b, c, test_site::Part::kLeaf);
  out.add_triangle(a, c, d, test_site::Part::kLeaf);
}

test_site::PlantMesh boards(int n) {
  test_site::PlantMesh out;
  for (int k = 0; k < n; ++k) add_board(out, M_PI * k / n);
  return out;
}

void add_stick(test_site::PlantMesh& out) {
  const test_site::TubePoint stick[] = {{{0, 0, 0}, 0.15}, {{0, 0, 2.5}, 0.1}};
  test_site::add_tube(out, stick, 8);
}

/// Returns a ball of leaves on a stick.
test_site::PlantMesh ball_on_stick(int around, int up) {
  test_site::PlantMesh out;
  add_stick(out);
  const auto at = [&](int i, int j) {
    const double zenith = M_PI * i / up, azimuth = 2 * M_PI * j / around;
    return Vec3(1.5 * std::sin(zenith) * std::cos(azimuth),
                1.5 * std::sin(zenith) * std::sin(azimuth), 3.5 + 1.5 * std::cos(zenith));
  };
  for (int i = 0; i < up; ++i) {
    for (int j = 0; j < around; ++j) {
      const uint32_t a = out.add_vertex(at(i, j)), b = out.add_vertex(at(i + 1, j));
      const uint32_t c = out.add_vertex(at(i + 1, j + 1)), d = out.add_vertex(at(i, j + 1));
      if (i + 1 < up) out.add_triangle(a, b, c, test_site::Part::kLeaf);
      if (i > 0) out.add_triangle(a, c, d, test_site::Part::kLeaf);
    }
  }
  scale(out);
  return out;
}

/// Returns cones on a stick, one above the other, each with its underside.
test_site::PlantMesh cones_on_stick(int cones, int around) {
  test_site::PlantMesh out;
  add_stick(out);
  for (int k = 0; k < cones; ++k) {
    const double base = 1 + 4.0 * k / cones, top = base + 1.5 * 4.0 / cones;
    const double radius = 1.5 * (1 - 0.7 * k / cones);
    const uint32_t tip = out.add_vertex({0, 0, top}), foot = out.add_vertex({0, 0, base});
    for (int j = 0; j < around; ++j) {
      const auto rim = [&](int i) {
        const double azimuth = 2 * M_PI * i / around;
        return out.add_vertex({radius * std::cos(azimuth), radius * std::sin(azimuth), base});
      };
      const uint32_t b = rim(j), c = rim(j + 1);
      out.add_triangle(tip, b, c, test_site::Part::kLeaf);
      out.add_triangle(foot, c, b, test_site::Part::kLeaf);
    }
  }
  scale(out);
  return out;
}

/// Returns a tree with few large leaves on few twigs, or with many small ones on many; the total
/// leaf area is the same.
test_site::PlantMesh tree_with(double leaf_length_m, test_site::Species species, uint64_t seed) {
  test_site::TreeParameters p = test_site::typical_tree(species, 5.5);
  p.crown_radius_m = 1.35;
  p.crown_base_m = 1;
  const double before = p.foliage.leaf_length_m;
  p.twig_spacing_m = std::clamp(1.2 * leaf_length_m, p.twig_spacing_m, 1.2);
  p.foliage.area_m2 = 3 * M_PI * p.crown_radius_m * p.crown_radius_m;
  p.foliage.leaf_length_m = leaf_length_m;
  p.foliage.leaf_width_m *= leaf_length_m / before;
  test_site::PlantMesh out = test_site::tree(p, seed);
  scale(out);
  return out;
}

test_site::PlantMesh shrub_with(double leaf_length_m, uint64_t seed) {
  test_site::ShrubParameters p = test_site::typical_shrub(3.5);
  const double before = p.foliage.leaf_length_m;
  p.twig_spacing_m = std::clamp(1.2 * leaf_length_m, p.twig_spacing_m, 1.2);
  p.foliage.leaf_width_m *= leaf_length_m / before;
  p.foliage.leaf_length_m = leaf_length_m;
  test_site::PlantMesh out = test_site::shrub(p, seed);
  scale(out);
  return out;
}

}  // namespace

std::vector<SweepPlant> sweep_plants(bool quick, uint64_t seed) {
  std::vector<SweepPlant> out;
  out.push_back({"billboard", boards(1), true});
  if (!quick) out.push_back({"two crossed boards", boards(2), true});
  if (!quick) out.push_back({"cartoon, a cone", cones_on_stick(1, 6), true});
  if (!quick) out.push_back({"cartoon, three cones", cones_on_stick(3, 12), true});
  out.push_back({"cartoon, a ball", ball_on_stick(12, 6), true});
  if (!quick) out.push_back({"cartoon, a round ball", ball_on_stick(36, 18), true});
  const auto add = [&](const char* kind, double length, test_site::PlantMesh plant) {
    out.push_back({fmt::format("{} {:g} mm", kind, 1000 * length), std::move(plant), false});
  };
  const auto lengths = [quick](std::vector<double> all) {
    return quick ? std::vector{all[1], all[all.size() - 3]} : all;
  };
  for (const double l : lengths({1.2, 0.6, 0.3, 0.15, 0.08, 0.04, 0.02, 0.0085}))
    add("broadleaf", l, tree_with(l, test_site::Species::kBroadleaf, seed));
  if (quick) return out;
  for (const double l : lengths({1.2, 0.6, 0.3, 0.15, 0.06, 0.025, 0.0085}))
    add("conifer", l, tree_with(l, test_site::Species::kConifer, seed));
  for (const double l : lengths({1, 0.5, 0.25, 0.12, 0.055, 0.02}))
    add("shrub", l, shrub_with(l, seed));
  return out;
}

std::vector<SweepPlant> given_plants(const std::filesystem::path& folder) {
  std::vector<SweepPlant> out;
  if (!std::filesystem::is_directory(folder)) return out;
  for (const plant_meshes::PlantSource& source : pipeline::plants_of_files(folder, {})) {
    SweepPlant plant{std::filesystem::path(source.name).stem().string(), {}, false};
    for (const Vec3f& v : source.vertices) plant.plant.add_vertex(v.cast<double>());
    for (const auto& [a, b, c] : source.triangles) {
      plant.plant.add_triangle(a, b, c, test_site::Part::kLeaf);
    }
    const auto box = test_site::bounds(plant.plant.mesh);
    const Vec3f foot = Vec3(box.center().x(), box.center().y(), box.min().z()).cast<float>();
    for (Vec3f& v : plant.plant.mesh.vertices) v -= foot;
    scale(plant.plant);
    out.push_back(std::move(plant));
  }
  return out;
}

}  // namespace underbrush::studies
