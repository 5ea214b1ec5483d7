/// \file
/// The elements of a model as tables of PLY files. This file is internal to the module.
#pragma once
#include <filesystem>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {

/// Returns a mesh as a table, with hit probabilities, light and roughness where `with_hits`.
io::PlyData ply_of_mesh(const TriangleMesh& mesh, bool with_hits);
/// Returns ellipsoids as a table.
io::PlyData ply_of_ellipsoids(const std::vector<Ellipsoid>& ellipsoids, bool with_light);

/// Reads a mesh with hit probabilities. Throws `FormatError`.
TriangleMesh read_mesh_table(const std::filesystem::path& file);
/// Reads ellipsoids. Throws `FormatError`.
std::vector<Ellipsoid> read_ellipsoid_table(const std::filesystem::path& file);

}  // namespace underbrush::elements
