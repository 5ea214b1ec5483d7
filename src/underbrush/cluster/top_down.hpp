/// \file
/// This file has the top-down clustering of [deschaud12] §III.C.2: recursive 2-means.
#pragma once
#include <string>

#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// The options of `top_down_clusters`.
struct TopDownOptions {
  /// The rule by which a cluster is left whole. `points` is that of the paper: a half would have
  /// fewer than `min_points` points. `range_likelihood` also leaves a cluster whole if its halves
  /// explain the ranges of its beams no better than the whole does, but always splits one wider
  /// than `largest_sigma_m`.
  std::string stop = "points";
  int min_points = 10;
  /// For `range_likelihood`: the least gain of a split over all points of the cluster, nats.
  double least_gain = 4;
  /// For `range_likelihood`: the greatest standard deviation of a cluster, m. Single returns that
  /// are far apart thus make small elements each, and not a large one that is mostly air.
  double largest_sigma_m = 0.2;
  double noise_m = 0.02;  ///< For `range_likelihood`: least standard deviation of a cluster, m.
  /// For `range_likelihood`: a beam meets a cluster within this Mahalanobis distance.
  double tau = 3;
};

/// Clusters points by recursive 2-means: it splits all points, then each half, and so on. Each
/// split is along the principal axis, by Lloyd's iteration on the projections, which starts from
/// the mean.
///
/// The rule `range_likelihood` compares the density of the measured ranges under the ray model. A
/// beam that meets both halves within τ draws its range from either, in proportion to their numbers
/// of points; one point in a hundred is an outlier. Flat matter gains nothing from a split and
/// stays whole, while porous or bent matter is split for as long as its points support it.
///
/// `points` are finite, in metres. `to_sensor` (of any length) is used by `range_likelihood` alone.
/// No random numbers are used, and the order of the points has no effect but for the rounding of
/// sums. Every point is in a cluster. Throws `std::invalid_argument` for an unknown rule and for
/// options out of range.
Clusters top_down_clusters(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                           const TopDownOptions& options);

}  // namespace underbrush::cluster
