/// \file
/// This file turns clusters of points into a Gaussian mixture, and can remove the footprints of the
/// beams from it.
#pragma once
#include <array>
#include <functional>

#include "underbrush/cluster/cluster.hpp"

namespace underbrush::cluster {

/// A function from a range (m) to the σ of the beam's cross-section there, horizontal and vertical
/// (m). An empty function means thin beams.
using Footprint = std::function<std::array<double, 2>(double range_m)>;

/// The options of `mixture`.
struct MixtureOptions {
  int rounds = 2;     ///< Rounds of expectation and maximisation.
  int shared_by = 3;  ///< Number of ellipsoids that share a point: those that began nearest to it.
  double least_points = 1;  ///< An ellipsoid that holds fewer points in the end is dropped.
  Footprint footprint;
};

/// Fits a Gaussian mixture that starts at `clusters`, by expectation–maximisation, and returns its
/// ellipsoids in the order of the clusters.
///
/// A measured point x = y + s is modelled as a draw y of the mixture, moved across its beam by s ~
/// N(0, S), where S is the covariance of the footprint at the point's range. This is extreme
/// deconvolution, [bovy11] eq. 15–16, and gives the extent of the matter without that of the beam.
/// Without a footprint S = 0, which is the plain mixture: ellipsoids share points, whereas clusters
/// divide them.
///
/// `points` are in metres; `to_sensor` (m) leads from each point to where it was seen from. Σ is
/// completed and floored as `ellipsoids_of` does, with n + ν in place of n − 1 + ν. p_hit is left
/// at 1. Components that lose their points are left out; `kept`, unless null, receives for each
/// cluster whether its component stays. Throws `std::invalid_argument` for options out of range.
std::vector<elements::Ellipsoid> mixture(std::span<const Vec3f> points,
                                         std::span<const Vec3f> to_sensor, const Clusters& clusters,
                                         const EllipsoidOptions& ellipsoid,
                                         const MixtureOptions& options,
                                         std::vector<bool>* kept = nullptr);

}  // namespace underbrush::cluster
