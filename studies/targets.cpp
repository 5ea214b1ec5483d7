#include "studies/targets.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/grass.hpp"
#include "underbrush/test_site/tree.hpp"

namespace underbrush::studies {
using namespace test_site;  // NOLINT: the targets are built of its plants
namespace {

void add_board(PlantMesh& mesh, const Vec3& foot, const Vec3& along, double height_m, Part part) {
  const Vec3 up = height_m * Vec3::UnitZ();
  const uint32_t a = mesh.add_vertex(foot), b = mesh.add_vertex(foot + along);
  const uint32_t c = mesh.add_vertex(foot + along + up), d = mesh.add_vertex(foot + up);
  mesh.add_triangle(a, b, c, part);
  mesh.add_triangle(a, c, d, part);
}

StaticTarget planes(uint64_t) {
  StaticTarget out;
  out.porous = false;
  const Vec3 edge(-0.25, 0, 0);
  for (const double side : {-1.0, 1.0}) {
    add_board(out.geometry, edge, 1.2 * Vec3(1, side, 0).normalized(), 2.5, Part::kWood);
  }
  out.centre_z_m = 1.5;
  return out;
}

StaticTarget small_tree(double lai, uint64_t seed) {
  TreeParameters p = typical_tree(Species::kBroadleaf, 2.8, lai);
  p.crown_radius_m = 0.75;
  p.crown_base_m = 0.9;
  p.foliage.leaf_length_m = 0.06;
  p.foliage.leaf_width_m = 0.04;
  p.foliage.area_m2 = lai * M_PI * p.crown_radius_m * p.crown_radius_m;
  StaticTarget out;
  out.geometry = tree(p, seed);
  out.centre_z_m = 1.8;
  return out;
}

// Returns a patch of grass as wide as the view, on bare ground.
StaticTarget grass(const GrassParameters& p, double half_height_m, uint64_t seed) {
  StaticTarget out;
  out.geometry = grass_patch(p, seed);
  const double reach = 0.5 * p.size_m;
  const uint32_t a = out.geometry.add_vertex({-reach, -reach, 0});
  const uint32_t b = out.geometry.add_vertex({reach, -reach, 0});
  const uint32_t c = out.geometry.add_vertex({reach, reach, 0});
  const uint32_t d = out.geometry.add_vertex({-reach, reach, 0});
  out.geometry.add_triangle(a, b, c, Part::kGround);
  out.geometry.add_triangle(a, c, d, Part::kGround);
  out.centre_z_m = half_height_m;
  out.half_height_m = half_height_m;
  return out;
}

StaticTarget tall_grass(uint64_t seed) {
  GrassParameters p;
  p.size_m = 1.2;
  p.height_m = 0.8;
  p.blades_per_m2 = 1000;
  return grass(p, 0.4, seed);
}

StaticTarget short_grass(uint64_t seed) { return grass(mowed_grass(3), 0.15, seed); }

struct Recipe {
  const char* name;
  StaticTarget (*make)(uint64_t seed);
};

constexpr Recipe kRecipes[] = {{"planes", planes},
                               {"tree_high", [](uint64_t seed) { return small_tree(4, seed); }},
                               {"tree_medium", [](uint64_t seed) { return small_tree(1.5, seed); }},
                               {"tree_low", [](uint64_t seed) { return small_tree(0.5, seed); }},
                               {"tall_grass", tall_grass},
                               {"short_grass", short_grass}};

}  // namespace

std::vector<std::string> static_target_names() {
  std::vector<std::string> names;
  for (const Recipe& r : kRecipes) names.emplace_back(r.name);
  return names;
}

StaticTarget static_target(const std::string& name, double distance_m, uint64_t seed) {
  require(distance_m >= 3, "a static target must be at least 3 m away");
  for (const Recipe& r : kRecipes) {
    if (name != r.name) continue;
    StaticTarget out = r.make(random_bits(seed, 0, Purpose::kPlace));
    out.name = name;
    for (Vec3f& v : out.geometry.mesh.vertices) v.x() += float(distance_m);
    return out;
  }
  throw std::invalid_argument("no static target '" + name + "'");
}

}  // namespace underbrush::studies
