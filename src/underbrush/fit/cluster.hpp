/// \file
/// From points to groups of points: the clusterings, free functions of one shape.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// From logs to models.
namespace fit {

/// Clusters of points: `group[i]` is the cluster of point i, in [0, count), or `kNone`.
struct Clusters {
  std::vector<uint32_t> group;
  uint32_t count = 0;
  static constexpr uint32_t kNone = 0xffffffffu;
};

/// Options of `hierarchical_clusters`.
struct HierarchicalOptions {
  double clusters_per_point = 0.1;  ///< Number of clusters = this × number of points.
  int min_points = 3;               ///< No cluster is made smaller than this by splitting.
  int branching = 2;                ///< k of the k-means at each split; 2 follows the data best.
  int iterations = 6;               ///< Of each k-means.
};

/// Hierarchical k-means as in [tallavajhula18] §IV (FLANN's): starts from one cluster and splits
/// the one of greatest sum of squares until there are `clusters_per_point` × n. `points` in metres;
/// fewer than `min_points` points give no cluster. Deterministic for a seed.
Clusters hierarchical_clusters(std::span<const Vec3f> points, const HierarchicalOptions& options,
                               uint64_t seed);

/// One ellipsoid a cluster with at least `min_points` points, in order of cluster: μ and Σ are the
/// sample moments (n − 1), Σ floored at the sensor's range noise `floor_m`. p_hit is left at 1.
std::vector<elements::Ellipsoid> ellipsoids_of(std::span<const Vec3f> points,
                                               const Clusters& clusters, int min_points,
                                               double floor_m);

}  // namespace fit
}  // namespace underbrush
