/// \file
/// Worlds in any third-party format that is known.
#pragma once
#include "underbrush/worlds/mesh_world.hpp"

namespace underbrush::worlds {

/// How the files of a world are read.
struct ReadOptions {
  MeshOptions mesh;
};

/// Whether `read_world` reads this file: a mesh.
bool is_world(const std::filesystem::path& path);
/// Reads the file. Throws `FormatError` as the readers do.
World read_world(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace underbrush::worlds
