/// \file
/// Triangles of glTF 2.0 files, for `read_mesh`.
#pragma once
#include "underbrush/io/mesh_file.hpp"

namespace underbrush::io {

/// Reads .gltf (with its buffers, also those in files beside it) or .glb: triangles, strips and
/// fans of the default scene's nodes, moved by their transforms (m, y up). Materials, skins, morph
/// targets and images are passed over. Throws `FormatError` for anything damaged, for sparse or
/// compressed positions, for a tree of nodes that is none.
MeshData read_gltf(const std::filesystem::path& path);

}  // namespace underbrush::io
