/// \file
/// This file has the clustering of [tallavajhula18]: hierarchical k-means.
#pragma once
#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// The options of `hierarchical_clusters`.
struct HierarchicalOptions {
  double clusters_per_point = 0.1;  ///< Number of clusters divided by the number of points.
  int min_points = 3;               ///< Splitting makes no cluster smaller than this.
  int branching = 2;                ///< k of the k-means at each split; 2 follows the data best.
  int iterations = 6;               ///< Most iterations of each k-means.
  /// m; a cluster whose points are nearer to their mean than this (root mean square) is not split.
  double least_rms_m = 0;
};

/// Clusters points by hierarchical k-means, as [tallavajhula18] §IV does with FLANN. It starts from
/// one cluster and splits the one with the greatest sum of squares until there are
/// `clusters_per_point` × n clusters. A cluster smaller than `least_rms_m`, as of a beam that
/// repeats its direction, is not split, and its points count no longer in n. The centres of large
/// clusters are found from a sample of their points.
///
/// `points` are in metres; fewer than `min_points` points give no cluster. The result is determined
/// by the seed and the order of the points. Throws `std::invalid_argument` for options out of
/// range.
Clusters hierarchical_clusters(std::span<const Vec3f> points, const HierarchicalOptions& options,
                               uint64_t seed);

}  // namespace underbrush::cluster
