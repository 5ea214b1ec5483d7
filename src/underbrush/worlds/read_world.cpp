#include "underbrush/worlds/read_world.hpp"

#include "underbrush/core/file.hpp"
#include "underbrush/worlds/voxel_file.hpp"

namespace underbrush::worlds {
namespace {

bool is_voxels(const std::filesystem::path& path) {
  return path.extension() == ".vox" && is_file(path);
}

}  // namespace

World read_voxel_world(const std::filesystem::path& path) {
  const VoxelFile voxels = read_voxels(path);
  const Vec3 split(voxels.split[0], voxels.split[1], voxels.split[2]);
  World world = empty_world(offset_of(voxels.low, voxels.low + voxels.side_m.cwiseProduct(split)));
  io::MeshScene leaves;
  leaves.parts = {{"", "leaf"}};
  leaves.left_out = voxels.left_out;
  const PartModels models = add_models(world, leaves, {}, world.report.offset_m);
  elements::Model& model = world.scene.models.back();
  model.fitter = "voxels";
  model.ellipsoids = ellipsoids_of(voxels, world.report.offset_m);
  model.tau = kVoxelTau;
  world.report.voxels = model.ellipsoids.size();
  if (!voxels.leaf_angles.empty() && voxels.leaf_angles != "Spherical") {
    ++world.report.left_out["leaf angles " + voxels.leaf_angles + ", which count as spherical"];
  }
  elements::Instance placed;
  placed.world_from_model.translation = world.report.offset_m;
  place(world, models, placed);
  return world;
}

bool is_world(const std::filesystem::path& path) {
  return is_mesh(path) || is_voxels(path) || is_helios(path);
}

std::span<const Option<ReadOptions>> read_options() {
  using O = ReadOptions;
  constexpr const char* kGroup = "Meshes and scenes of HELIOS++";
  // clang-format off
  static const Option<O> kOptions[] = {
    {"up", kGroup, "", kUpHelp,
     [](O& o) -> auto& { return o.mesh.up; }, -kNoLimit, kNoLimit, {"y", "z"}},
    {"unit", kGroup, "m", kUnitHelp,
     [](O& o) -> auto& { return o.mesh.unit_m; }, 1e-4, 1e4},
    {"assets", kGroup, "", "Folder with the files of a scene of HELIOS++, besides the folder of the scene",
     [](O& o) -> auto& { return o.assets; }, -kNoLimit, kNoLimit, {}, "FOLDER"},
  };
// clang-format on
return kOptions;
}

World read_world(const std::filesystem::path& path, const ReadOptions& options) {
  if (is_voxels(path)) return read_voxel_world(path);
  if (is_helios(path)) return read_helios_scene(path, "", options.assets);
  return read_mesh_world(path, options.mesh);
}

}  // namespace underbrush::worlds
