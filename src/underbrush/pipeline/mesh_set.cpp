#include "underbrush/pipeline/mesh_set.hpp"

#include <algorithm>

namespace underbrush::pipeline {

std::span<const Option<MeshesOptions>> meshes_options() {
  using O = MeshesOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"variation", "", "",
     "With generated: vary the demo's species by multiplying crown radius and base, trunk, leaf area "
     "and leaf size by factors from 1/F to F",
     [](O& o) -> auto& { return o.variation; }, 1, 2, {}, "F"},
    {"unit", "", "m", worlds::kUnitHelp,
     [](O& o) -> auto& { return o.files.unit_m; }, 1e-4, 1e4},
    {"up", "", "", worlds::kUpHelp,
     [](O& o) -> auto& { return o.files.up; }, -kNoLimit, kNoLimit, {"y", "z"}},
    {"sizes", "", "", "Number of heights of each plant in each class",
     [](O& o) -> auto& { return o.meshes.sizes_per_class; }, 1, 100},
    {"most-scaling", "", "", "Scale a plant by at most this factor, up or down",
     [](O& o) -> auto& { return o.meshes.most_scaling; }, 1, 1e6},
    {"patch-cell", "", "m", "Side of the cells of patches of shrubs",
     [](O& o) -> auto& { return o.meshes.cell_m; }, 0.05, 1000},
    {"range-noise", "", "m", "Standard deviation of the noise on ranges",
     [](O& o) -> auto& { return o.meshes.range_sigma_m; }, 0, 2},
  };
// clang-format on
return kOptions;
}

MeshSet mesh_set(const std::vector<std::string>& plants, const MeshesOptions& options) {
  check_options("meshes", meshes_options(), options);
  std::vector<plant_meshes::PlantSource> sources;
  MeshSet out;
  for (const std::string& name : plants) {
    const bool generated = name == "generated";
    auto some = generated ? generated_plants(options.meshes.seed, options.variation)
                          : plants_of_files(name, options.files);
    for (plant_meshes::PlantSource& plant : some) {
      if (!generated) out.inputs.emplace_back(plant.name);
      sources.push_back(std::move(plant));
    }
  }
  out.plants = sources.size();
  out.primitives = plant_meshes::mesh_primitives(sources, options.meshes);
  for (const primitives::Primitive& p : out.primitives) {
    for (const primitives::PlantPlacement& plant : p.plants) {
      out.least_scale = std::min(out.least_scale, plant.scale);
      out.most_scale = std::max(out.most_scale, plant.scale);
    }
  }
  return out;
}

}  // namespace underbrush::pipeline
