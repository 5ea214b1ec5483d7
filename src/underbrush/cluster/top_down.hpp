/// \file
/// This file has the top-down clustering of [deschaud12] §III.C.2: recursive 2-means.
#pragma once

#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// The options of `top_down_clusters`.
struct TopDownOptions {
  int min_points = 10;    ///< A cluster stays whole if a half would have fewer points.
  double noise_m = 0.02;  ///< The least standard deviation of a cluster, m.
};

/// Clusters points by recursive 2-means: it splits all points, then each half, and so on. Each
/// split is along the principal axis, by Lloyd's iteration on the projections, which starts from
/// the mean.
///
/// `points` are finite, in metres. No random numbers are used, and the order of the points has no
/// effect but for the rounding of sums. Every point is in a cluster. Throws
/// `std::invalid_argument` for options out of range.
Clusters top_down_clusters(std::span<const Vec3f> points, const TopDownOptions& options);

}  // namespace underbrush::cluster
