/// \file
/// Reader of glTF 2.0 meshes, for `read_mesh_scene`.
#pragma once
#include "underbrush/io/mesh_scene.hpp"

namespace underbrush::io {

/// Reads the triangles, strips and fans of the default scene of a .gltf file (with its buffers,
/// also those in files beside it) or a .glb file, moved by the nodes' transforms (m, y up).
/// Nodes are objects, and of materials the names alone are kept; skins, morph targets and images
/// are ignored. Throws `FormatError` for damaged files,
/// for sparse or compressed positions, and where the nodes do not form a tree.
MeshScene read_gltf(const std::filesystem::path& path);

}  // namespace underbrush::io
