/// \file
/// The bottom-up clustering of [deschaud12] §III.C.3: small ellipsoids merged while the density of
/// points allows.
#pragma once
#include "underbrush/fit/cluster.hpp"

namespace underbrush::fit {

/// Options of `bottom_up_clusters`.
struct BottomUpOptions {
  double cell_m = 0.1;  ///< Side of the cubes that hold the first, small ellipsoids.
  /// A merged ellipsoid must hold at least this share of the points per volume that its two parts
  /// hold together: one keeps only what fits as if it had always been one, 0 merges everything.
  double least_density = 0.6;
  int min_points = 1;    ///< Points of smaller clusters are left out at the end.
  double largest_m = 1;  ///< No merged ellipsoid is longer: √12 times the root of its variance.
};

/// Starts from the occupied cubes and merges, always the two neighbours that lose the least
/// density, until no merger is allowed. Density is n / √det Σ with Σ = (scatter + 3 σ² I) / (n +
/// 3), σ² = `cell_m`² / 12: a lone point stands for its cube. Neighbours are clusters with cubes
/// that touch. The order of the points (finite) does not matter but for the rounding of sums.
Clusters bottom_up_clusters(std::span<const Vec3f> points, const BottomUpOptions& options);

}  // namespace underbrush::fit
