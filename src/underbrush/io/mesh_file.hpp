/// \file
/// Triangle meshes in others' formats.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// Triangles and nothing else: no normals, colours or textures.
struct MeshData {
  std::vector<Vec3f> vertices;  ///< In the file's own unit and axes.
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Extensions that `read_mesh` takes: .obj, .ply, .gltf, .glb.
std::vector<std::string> mesh_extensions();

/// Whether the extension says glTF, whose axes and unit are given: y up, metres.
bool is_gltf(const std::filesystem::path& path);

/// Reads OBJ (v and f lines; polygons become fans, all groups one mesh), PLY (elements vertex and
/// face) or glTF (`read_gltf`), by the extension. Throws `FormatError` for another extension, a
/// mesh without triangles, a coordinate that is no finite number, a face that names no vertex.
MeshData read_mesh(const std::filesystem::path& path);

}  // namespace underbrush::io
