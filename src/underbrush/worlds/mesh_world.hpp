/// \file
/// A mesh file as a world of its own, with its coordinates, groups, materials and classes.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "underbrush/elements/scene.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/mesh_scene.hpp"

namespace underbrush {
/// Worlds in third-party formats: meshes, scenes and surveys of HELIOS++, voxels of AMAPVox.
namespace worlds {

/// The conversion of the coordinates of a mesh file to those of the world.
struct MeshOptions {
  double unit_m = 1;  ///< m; length of the file's unit.
  /// "z", or "y": x, y, z of the file become x, −z, y, as they always do in glTF.
  std::string up = "z";
};

/// The help of the options of these fields.
inline constexpr const char *kUnitHelp = "Length of the unit of mesh files",
                            *kUpHelp =
                                "Axis that points up in mesh files; in glTF files it is always y";

/// The report on the conversion of a file, for people to read.
struct WorldReport {
  size_t parts = 0, triangles = 0, voxels = 0;
  /// m, world; all coordinates are stored relative to it in single precision.
  Vec3 offset_m = Vec3::Zero();
  double rounding_m = 0;  ///< m; the largest change of a coordinate by that.
  double unit_m = 1;
  bool y_up = false;
  size_t without_material = 0;  ///< Parts whose reflectance the file does not state.
  /// Number of things that the files have and that are not used, by kind.
  std::map<std::string, size_t> left_out;
};

/// A world that was read from third-party files.
struct World {
  elements::Scene scene;
  elements::SceneInfo info;
  WorldReport report;
};

/// Returns the offset of a world with these bounds (m): zero within 256 m of zero, else the middle
/// in whole metres.
Vec3 offset_of(const Vec3& low, const Vec3& high);

/// Returns an empty world, whose instance 0 has no elements. Instances count from 1.
World empty_world(const Vec3& offset);
/// The models of a mesh's parts.
struct PartModels {
  std::vector<uint32_t> model;
  std::vector<elements::Class> label;
};
/// Appends a model for each part of a mesh. Its coordinates are those of `vertices` (m) less
/// `offset`. The class of a part is its object's name if that is one of `elements::kClassNames`,
/// else `las_N` of its material's classification N (`ground` for 2), else its material's name, else
/// its object's name. Surfaces have no noise.
PartModels add_models(World& world, const io::MeshScene& mesh, const std::vector<Vec3>& vertices,
                      const Vec3& offset);
/// Places models; `placed` is the place of each.
void place(World& world, const PartModels& models, const elements::Instance& placed);

/// Whether the path is a file with the extension of a mesh that is not a log: a PLY file counts if
/// it has faces.
bool is_mesh(const std::filesystem::path& path);
/// Reads a mesh file as a world. Throws `FormatError` as `io::read_mesh_scene` does.
World read_mesh_world(const std::filesystem::path& path, const MeshOptions& options = {});

}  // namespace worlds
}  // namespace underbrush
