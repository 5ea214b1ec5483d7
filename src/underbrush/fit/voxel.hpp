/// \file
/// The regular grid of [deschaud12] §III.C.1: one cluster an occupied cube.
#pragma once
#include "underbrush/fit/cluster.hpp"

namespace underbrush::fit {

/// Options of `voxel_clusters`.
struct VoxelOptions {
  /// Side of a cube, m. [deschaud12] §VI: 0.3 for a mobile log, 0.05 for a standing scanner.
  double side_m = 0.3;
  int min_points = 1;  ///< Points of cubes with fewer are left out.
  /// Whether a beam meets a Gaussian only where its closest approach lies in the Gaussian's own
  /// cube (`Model::voxel_m`), for counts and in simulation. Else its τ-isosurface is its only
  /// bound.
  bool bounded = false;
};

/// Occupied cubes [i, i+1) × [j, j+1) × [k, k+1) sides about the origin of the points' frame.
struct Voxels {
  Clusters clusters;           ///< Numbered by (i, j, k): the order of the points does not matter.
  std::vector<uint64_t> code;  ///< Place of each cluster, ascending: `voxel_step` leads on.
};

/// Difference of the codes of cubes (di, dj, dk) apart. Cubes at the border of what is occupied
/// have neighbours too: no step leads around to the other side.
constexpr int64_t voxel_step(int di, int dj, int dk) {
  return int64_t(di) * (int64_t(1) << 42) + int64_t(dj) * (int64_t(1) << 21) + dk;
}

/// The cubes that hold points (finite, m). Throws `std::invalid_argument` where the side is not
/// positive or an axis spans more than 2 000 000 cubes.
Voxels occupied_voxels(std::span<const Vec3f> points, double side_m);

/// One cluster a cube with at least `min_points` points, which are finite. The order of the points
/// does not matter, and a shift by whole sides changes nothing.
Clusters voxel_clusters(std::span<const Vec3f> points, const VoxelOptions& options);

}  // namespace underbrush::fit
