/// \file
/// The clustering of [tallavajhula18]: hierarchical k-means.
#pragma once
#include "underbrush/fit/cluster.hpp"

namespace underbrush::fit {

/// Options of `hierarchical_clusters`.
struct HierarchicalOptions {
  double clusters_per_point = 0.1;  ///< Number of clusters = this × number of points.
  int min_points = 3;               ///< No cluster is made smaller than this by splitting.
  int branching = 2;                ///< k of the k-means at each split; 2 follows the data best.
  int iterations = 6;               ///< Of each k-means.
};

/// Hierarchical k-means as in [tallavajhula18] §IV (FLANN's): starts from one cluster and splits
/// the one of greatest sum of squares until there are `clusters_per_point` × n. Centres of large
/// clusters are found in a sample of their points. `points` in metres; fewer than `min_points`
/// points give no cluster. Deterministic for a seed and an order of points.
Clusters hierarchical_clusters(std::span<const Vec3f> points, const HierarchicalOptions& options,
                               uint64_t seed);

}  // namespace underbrush::fit
