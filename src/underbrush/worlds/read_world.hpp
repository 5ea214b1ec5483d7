/// \file
/// Worlds in any third-party format that is known.
#pragma once
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/worlds/helios_scene.hpp"
#include "underbrush/worlds/mesh_world.hpp"

namespace underbrush::worlds {

/// The options for reading the files of a world.
struct ReadOptions {
  MeshOptions mesh;
  std::string assets;  ///< Folder in which a scene of HELIOS++ has its files, too.
};
/// The table of these options.
std::span<const Option<ReadOptions>> read_options();

/// Whether `read_world` reads this file: a mesh, a scene or survey of HELIOS++ (.xml), or voxels of
/// AMAPVox (.vox).
bool is_world(const std::filesystem::path& path);
/// Reads voxels of AMAPVox as a world of one instance of class `leaf` (`ellipsoids_of`). Throws
/// `FormatError`.
World read_voxel_world(const std::filesystem::path& path);
/// Reads the file. Throws `FormatError` as the readers do.
World read_world(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace underbrush::worlds
