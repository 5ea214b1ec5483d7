#include "underbrush/scene/prototypes.hpp"

#include <algorithm>
#include <functional>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/scene/grass.hpp"
#include "underbrush/scene/shrub.hpp"
#include "underbrush/scene/tree.hpp"

namespace underbrush::scene {
namespace {

struct Recipe {
  std::string name;
  std::function<PlantMesh(uint64_t)> make;
};

Recipe tree_recipe(Species species, double height_m, double lai, LeafAngle angles) {
  TreeParameters p = typical_tree(species, height_m, lai);
  p.foliage.angles = angles;
  const std::string kind = species == Species::kBroadleaf ? "broadleaf" : "conifer";
  return {kind + "_" + std::to_string(int(height_m)) + "m",
          [p](uint64_t seed) { return tree(p, seed); }};
}

Recipe shrub_recipe(double height_m, double lai) {
  const ShrubParameters p = typical_shrub(height_m, lai);
  return {"shrub_" + std::to_string(int(100 * height_m)) + "cm",
          [p](uint64_t seed) { return shrub(p, seed); }};
}

Recipe tussock_recipe(double height_m) {
  GrassParameters p;
  p.height_m = height_m;
  p.tussock_radius_m = 0.16;
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

PrototypeSet make_prototypes(uint64_t seed) {
  using enum LeafAngle;
  std::vector<Recipe> recipes;
  PrototypeSet set;
  const auto close = [&](PrototypeRange& range) {
    range.begin = uint32_t(set.prototypes.size());
    set.prototypes.resize(recipes.size());
    range.end = uint32_t(recipes.size());
  };
  for (const double h : {13.5, 12.0, 10.8}) {
    recipes.push_back(tree_recipe(Species::kBroadleaf, h, h > 12.5 ? 2.2 : 2.5, kSpherical));
  }
  recipes.push_back(tree_recipe(Species::kConifer, 12.5, 3, kSpherical));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 8.8, 1.6, kPlagiophile));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 7.2, 3, kPlanophile));
  recipes.push_back(tree_recipe(Species::kConifer, 8.0, 3, kSpherical));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 5.2, 3, kSpherical));
  recipes.push_back(tree_recipe(Species::kBroadleaf, 4.4, 2, kPlanophile));
  recipes.push_back(tree_recipe(Species::kConifer, 5.0, 3, kSpherical));
  close(set.trees);
  for (const double h : {2.6, 2.2, 1.7, 1.25, 0.85, 0.65, 0.42, 0.35}) {
    recipes.push_back(shrub_recipe(h, h > 2.5 ? 1.6 : 2.1));
  }
  close(set.shrubs);
  for (const double h : {0.45, 0.6, 0.75, 0.9}) recipes.push_back(tussock_recipe(h));
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

}  // namespace underbrush::scene
