/// \file
/// This file has the bottom-up clustering of [deschaud12] §III.C.3: it merges small ellipsoids for
/// as long as the density of points allows.
#pragma once
#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// The options of `bottom_up_clusters`.
struct BottomUpOptions {
  double cell_m = 0.1;  ///< Side of the cubes that hold the first, small ellipsoids, m.
  /// A merged ellipsoid must have at least this share of the points per volume that its two parts
  /// have together. A value of 1 allows only mergers that lose no density, and 0 allows all.
  double least_density = 0.6;
  int min_points = 1;    ///< Points of smaller clusters are left out at the end.
  double largest_m = 1;  ///< Longest extent of a merged ellipsoid, √12 σ, m.
};

/// Clusters points by mergers. It starts from one cluster for each occupied cube and always merges
/// the two neighbours that lose the least density, until no merger is allowed. Clusters are
/// neighbours if they have cubes that touch.
///
/// The density of n points is n / √det Σ with Σ = (scatter + 3 σ² I) / (n + 3) and σ² = `cell_m`² /
/// 12, the variance of points spread evenly over a cube, so that a single point has the volume of
/// its cube. `points` are finite, in metres. Their order has no effect but for the rounding of
/// sums. Throws `std::invalid_argument` for options out of range.
Clusters bottom_up_clusters(std::span<const Vec3f> points, const BottomUpOptions& options);

}  // namespace underbrush::cluster
