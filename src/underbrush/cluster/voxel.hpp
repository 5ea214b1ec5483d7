/// \file
/// This file has the clustering of [deschaud12] §III.C.1: a regular grid with one cluster for each
/// occupied cube.
#pragma once
#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// The options of `voxel_clusters`.
struct VoxelOptions {
  /// The side of a cube, m. [deschaud12] §VI has 0.3 for a mobile log and 0.05 for a standing
  /// scanner.
  double side_m = 0.3;
  int min_points = 1;  ///< Points of cubes with fewer points are left out.
  /// Whether a beam meets a Gaussian only if its point of closest approach lies in the Gaussian's
  /// own cube (`Model::voxel_m`). It applies to counting and to simulation. Otherwise only τ bounds
  /// the Gaussian.
  bool bounded = false;
};

/// The cubes that hold points: [i, i+1) × [j, j+1) × [k, k+1) sides from the origin of the points'
/// frame.
struct Voxels {
  Clusters clusters;  ///< Clusters in order of (i, j, k); the order of the points has no effect.
  /// Code of each cluster's cube, ascending; `voxel_step` leads to other cubes.
  std::vector<uint64_t> code;
};

/// Computes the difference between the codes of two cubes that are (di, dj, dk) cubes apart. Codes
/// leave room around the occupied cubes, so that a step from a cube at the border never reaches the
/// opposite side.
constexpr int64_t voxel_step(int di, int dj, int dk) {
  return int64_t(di) * (int64_t(1) << 42) + int64_t(dj) * (int64_t(1) << 21) + dk;
}

/// Finds the cubes that hold points (finite, m). Throws `std::invalid_argument` where the side is
/// not positive or an axis spans more than 2 000 000 cubes.
Voxels occupied_voxels(std::span<const Vec3f> points, double side_m);

/// Makes one cluster for each cube with at least `min_points` points. Points are finite, in metres.
/// Their order has no effect, and a shift by whole sides changes nothing. Throws
/// `std::invalid_argument` as `occupied_voxels` does.
Clusters voxel_clusters(std::span<const Vec3f> points, const VoxelOptions& options);

}  // namespace underbrush::cluster
