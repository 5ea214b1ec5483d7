/// \file
/// Readers of triangle meshes in third-party formats.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// Triangles alone, without normals, colours or textures.
struct MeshData {
  std::vector<Vec3f> vertices;  ///< In the unit and axes of the file.
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// Returns the extensions that `read_mesh` takes: .obj, .ply, .gltf, .glb.
std::vector<std::string> mesh_extensions();

/// Whether the extension means glTF, which prescribes axes and unit: y up, metres.
bool is_gltf(const std::filesystem::path& path);

/// Reads a mesh in the format that its extension names: OBJ (v and f lines; polygons become fans,
/// all groups one mesh), PLY (elements vertex and face) or glTF (`read_gltf`). Throws `FormatError`
/// for another extension, a mesh without triangles, a coordinate that is not a finite number, or a
/// face that names no vertex.
MeshData read_mesh(const std::filesystem::path& path);

}  // namespace underbrush::io
