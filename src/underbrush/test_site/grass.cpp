#include "underbrush/test_site/grass.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {
namespace {

void check(const GrassParameters& p) {
  require(p.size_m > 0 && p.height_m > 0 && p.blade_width_m > 0 && p.blades_per_m2 >= 0 &&
              p.tussocks_per_m2 >= 0 && p.tussock_radius_m > 0 && p.lean >= 0 && p.segments > 0,
          "grass: impossible size");
}

// Adds a blade along a quadratic Bézier curve from the root over a point above it to the tip; it
// narrows towards the tip.
void add_blade(PlantMesh& plant, const GrassParameters& p, const Vec3& root, double azimuth,
               Stream& random) {
  const double height_m = p.height_m * (1 + 0.2 * std::clamp(random.normal(), -3.0, 3.0));
  const double lean_m = height_m * p.lean * random.uniform(0.2, 1.8);
  const Vec3 out(std::cos(azimuth), std::sin(azimuth), 0);
  const Vec3 above = root + 0.15 * lean_m * out + 0.8 * height_m * Vec3::UnitZ();
  const Vec3 tip = root + lean_m * out + height_m * Vec3::UnitZ();
  const double facing = azimuth + random.uniform(-0.6, 0.6);
  const Vec3 across(-std::sin(facing), std::cos(facing), 0);
  const double width_m = p.blade_width_m * random.uniform(0.7, 1.3);
  uint32_t left = 0, right = 0;
  for (int i = 0; i < p.segments; ++i) {
    const double t = double(i) / p.segments;
    const Vec3 at = (1 - t) * (1 - t) * root + 2 * t * (1 - t) * above + t * t * tip;
    const Vec3 half = 0.5 * width_m * (1 - 0.5 * t) * across;
    const uint32_t l = plant.add_vertex(at - half), r = plant.add_vertex(at + half);
    if (i > 0) {
      plant.add_triangle(left, right, r, Part::kBlade);
      plant.add_triangle(left, r, l, Part::kBlade);
    }
    left = l, right = r;
  }
  plant.add_triangle(left, right, plant.add_vertex(tip), Part::kBlade);
}

// Adds a blade that roots near the middle of its tussock and leans away from it.
void add_tussock_blade(PlantMesh& plant, const GrassParameters& p, const Vec3& middle,
                       Stream& random) {
  const double azimuth = random.uniform(0, 2 * M_PI);
  const double r = p.tussock_radius_m * std::sqrt(random.uniform());
  const Vec3 root = middle + r * Vec3(std::cos(azimuth), std::sin(azimuth), 0);
  add_blade(plant, p, root, azimuth + random.uniform(-0.9, 0.9), random);
}

}  // namespace

GrassParameters mowed_grass(double size_m) {
  GrassParameters p;
  p.size_m = size_m;
  p.height_m = 0.05;
  p.blades_per_m2 = 1500;
  p.tussocks_per_m2 = 0;
  p.blade_width_m = 0.005;
  p.lean = 0.4;
  p.segments = 1;
  return p;
}

PlantMesh grass_patch(const GrassParameters& p, uint64_t seed) {
  check(p);
  Stream random(seed);
  const double area_m2 = p.size_m * p.size_m, reach = 0.5 * p.size_m;
  const auto place = [&](double margin) {
    Vec3 at = Vec3::Zero();
    at.x() = (reach - margin) * random.uniform(-1, 1);
    at.y() = (reach - margin) * random.uniform(-1, 1);
    return at;
  };
  std::vector<Vec3> tussocks(size_t(std::lround(p.tussocks_per_m2 * area_m2)));
  for (Vec3& t : tussocks) t = place(std::min(p.tussock_radius_m, reach));
  PlantMesh plant;
  const auto blades = size_t(std::lround(p.blades_per_m2 * area_m2));
  for (size_t i = 0; i < blades; ++i) {
    if (tussocks.empty()) {
      const Vec3 root = place(0);
      add_blade(plant, p, root, random.uniform(0, 2 * M_PI), random);
    } else {
      add_tussock_blade(plant, p, tussocks[i % tussocks.size()], random);
    }
  }
  return plant;
}

PlantMesh tussock(const GrassParameters& p, int blades, uint64_t seed) {
  check(p);
  require(blades > 0, "grass: a tussock needs blades");
  Stream random(seed);
  PlantMesh plant;
  for (int i = 0; i < blades; ++i) add_tussock_blade(plant, p, Vec3::Zero(), random);
  return plant;
}

}  // namespace underbrush::test_site
