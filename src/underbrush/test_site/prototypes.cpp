#include "underbrush/test_site/prototypes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/grass.hpp"
#include "underbrush/test_site/shrub.hpp"
#include "underbrush/test_site/tree.hpp"

namespace underbrush::test_site {
namespace {

struct Recipe {
  std::string name;
  std::function<PlantMesh(uint64_t)> make;
};

/// Draws factors between 1 / variation and variation, uniformly in the logarithm.
class Habit {
 public:
  Habit(double variation, uint64_t seed) : reach_(std::log(variation)), random_(seed) {}
  double factor() { return std::exp(reach_ * random_.uniform(-1, 1)); }
  Foliage other(Foliage f, double crown) {
    f.area_m2 *= crown * crown * factor();
    const double leaf = factor();
    f.leaf_length_m *= leaf;
    f.leaf_width_m *= leaf;
    return f;
  }

 private:
  double reach_;
  Stream random_;
};

Recipe tree_recipe(Species species, double height_m, double lai, LeafAngle angles, Habit& habit) {
  TreeParameters p = typical_tree(species, height_m, lai);
  p.foliage.angles = angles;
  const double crown = habit.factor();
  p.crown_radius_m *= crown;
  p.crown_base_m *= habit.factor();
  p.trunk_radius_m *= habit.factor();
  p.foliage = habit.other(p.foliage, crown);
  const std::string kind = species == Species::kBroadleaf ? "broadleaf" : "conifer";
  return {kind + "_" + std::to_string(int(height_m)) + "m",
          [p](uint64_t seed) { return tree(p, seed); }};
}

Recipe shrub_recipe(double height_m, double lai, Habit& habit) {
  ShrubParameters p = typical_shrub(height_m, lai);
  const double crown = habit.factor();
  p.radius_m *= crown;
  p.foliage = habit.other(p.foliage, crown);
  return {"shrub_" + std::to_string(int(100 * height_m)) + "cm",
          [p](uint64_t seed) { return shrub(p, seed); }};
}

Recipe tussock_recipe(double height_m, Habit& habit) {
  GrassParameters p;
  p.height_m = height_m;
  p.tussock_radius_m = 0.16 * habit.factor();
  return {"tussock_" + std::to_string(int(100 * height_m)) + "cm",
          [p](uint64_t seed) { return tussock(p, 60, seed); }};
}

Recipe mowed_recipe() {
  return {"mowed", [](uint64_t seed) {
            GrassParameters p = mowed_grass(1);
            p.tussock_radius_m = 0.35;
            return tussock(p, 90, seed);
          }};
}

}  // namespace

PrototypeSet make_prototypes(uint64_t seed, double variation) {
  using enum LeafAngle;
  require(variation >= 1 && variation <= 2, "plants: the variation must lie in [1, 2]");
  Habit habit(variation, random_bits(seed, UINT32_MAX, Purpose::kPlace));
  std::vector<Recipe> recipes;
  PrototypeSet set;
  const auto close = [&](PrototypeRange& range) {
    range.begin = uint32_t(set.prototypes.size());
    set.prototypes.resize(recipes.size());
    range.end = uint32_t(recipes.size());
  };
  for (const double h : {13.5, 12.0, 10.8}) {
    recipes.push_back(tree_recipe(Species::kBroadleaf, h, h > 12.5 ? 2.2 : 2.5, kSpherical, habit));
  }
  recipes.push_back(tree_recipe(Species::kConifer, 12.5, 3, kSpherical, habit));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 8.8, 1.6, kPlagiophile, habit));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 7.2, 3, kPlanophile, habit));
  recipes.push_back(tree_recipe(Species::kConifer, 8.0, 3, kSpherical, habit));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 5.2, 3, kSpherical, habit));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 4.4, 2, kPlanophile, habit));
  recipes.push_back(tree_recipe(Species::kConifer, 5.0, 3, kSpherical, habit));
  close(set.trees);
  for (const double h : {2.6, 2.2, 1.7, 1.25, 0.85, 0.65, 0.42, 0.35}) {
    recipes.push_back(shrub_recipe(h, h > 2.5 ? 1.6 : 2.1, habit));
  }
  close(set.shrubs);
  for (const double h : {0.45, 0.6, 0.75, 0.9}) recipes.push_back(tussock_recipe(h, habit));
  close(set.tussocks);
  for (int i = 0; i < 2; ++i) recipes.push_back(mowed_recipe());
  close(set.mowed);

  parallel_for(recipes.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Prototype& p = set.prototypes[i];
      p.name = recipes[i].name;
      p.plant = recipes[i].make(random_bits(seed, uint32_t(i), Purpose::kPlace));
      for (const Vec3f& v : p.plant.mesh.vertices) {
        p.height_m = std::max(p.height_m, double(v.z()));
        p.radius_m = std::max(p.radius_m, double(v.head<2>().norm()));
      }
    }
  });
  return set;
}

}  // namespace underbrush::test_site
