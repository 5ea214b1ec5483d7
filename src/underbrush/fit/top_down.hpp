/// \file
/// The top-down clustering of [deschaud12] §III.C.2: recursive 2-means.
#pragma once
#include <string>

#include "underbrush/fit/cluster.hpp"

namespace underbrush::fit {

/// Options of `top_down_clusters`.
struct TopDownOptions {
  /// When a cluster is left whole. `points`, the paper's: when a half would have fewer than
  /// `min_points`. `range_likelihood`: besides, when the halves explain the ranges of its beams no
  /// better than the whole does; but one larger than `largest_sigma_m` is always split.
  std::string stop = "points";
  int min_points = 10;
  /// `range_likelihood`: what a split must gain over all points of the cluster, nats.
  double least_gain = 4;
  /// `range_likelihood`: greatest standard deviation of a cluster, m. Lone returns that are far
  /// apart make small elements of their own rather than a large one of much air.
  double largest_sigma_m = 0.2;
  double noise_m = 0.02;  ///< `range_likelihood`: least standard deviation of a cluster.
  double tau = 3;         ///< `range_likelihood`: a beam meets a cluster within this.
};

/// Splits all points, then each half, and so on, by 2-means along the principal axis (Lloyd's
/// iteration on the projections, from the mean).
///
/// The rule `range_likelihood` compares the density of the measured ranges under the ray model: a
/// beam that meets both halves within τ draws its range from either in proportion to their numbers
/// of points, and one point in a hundred is an outlier. Flat matter gains nothing from a split and
/// stays whole; porous or bent matter is split for as long as its points tell where.
///
/// `to_sensor` (of any length) is used by `range_likelihood` alone. No random numbers: the order of
/// the points (finite) does not matter but for the rounding of sums. Every point is in a cluster.
/// Throws `std::invalid_argument` for an unknown rule or options out of range.
Clusters top_down_clusters(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                           const TopDownOptions& options);

}  // namespace underbrush::fit
