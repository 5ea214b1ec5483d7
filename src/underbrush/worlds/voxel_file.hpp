/// \file
/// Voxels of AMAPVox (.vox) as a world of permeable elements.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/io/mesh_scene.hpp"

namespace underbrush::worlds {

/// A grid of voxels and the plant area density in those that the file lists.
struct VoxelFile {
  Vec3 low = Vec3::Zero();          ///< m; corner of the grid.
  Vec3 side_m = Vec3::Zero();       ///< Sides of a voxel.
  std::array<uint32_t, 3> split{};  ///< Number of voxels along each axis.
  std::vector<std::array<uint32_t, 3>> cell;
  std::vector<double> area_density_per_m;  ///< m²/m³, one for each cell; one-sided area.
  std::string leaf_angles;                 ///< `lad_type` of the header; empty if there is none.
  std::map<std::string, size_t> left_out;  ///< Rows that are not used, by reason.
};

/// Reads a .vox file: the line VOXEL SPACE, header lines `#KEY: VALUE` (min_corner, max_corner,
/// split, res), the names of the columns, and a row for each voxel with i, j, k and PadBVTotal (or
/// pad, or PAD). Rows whose density is not a number are counted. Throws `FormatError` where the
/// file is damaged, and where an index lies outside the grid.
VoxelFile read_voxels(const std::filesystem::path& path);

/// Returns the ellipsoids of the voxels with a positive density, relative to `offset` (m).
///
/// A voxel of the sides a, b, c becomes a Gaussian volume of the standard deviations a/2, b/2, c/2
/// about its centre, whose density along a ray is κ exp(−δ²/2) with
///   κ = G · PAD · a b c / ((2π)^(3/2) · (a/2)(b/2)(c/2) · (1 − exp(−τ²/2))),   G = 1/2,
/// so that the opacity is 1 − exp(−∫ density), and the mean of the optical depth over parallel rays
/// is that of the voxel, G · PAD · path. In a homogeneous grid the optical depth differs between
/// rays by up to 3 %. G = 1/2 is the projection of leaves of all directions alike.
std::vector<elements::Ellipsoid> ellipsoids_of(const VoxelFile& voxels, const Vec3& offset);
/// τ of a model of these ellipsoids.
inline constexpr double kVoxelTau = 3;

/// Returns the listed voxels as cubes of twelve triangles, in one part.
io::MeshScene cubes_of(const VoxelFile& voxels);

}  // namespace underbrush::worlds
