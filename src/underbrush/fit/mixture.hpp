/// \file
/// Clusters of points made a Gaussian mixture, looked at through the footprints of the beams.
#pragma once
#include <array>
#include <functional>

#include "underbrush/fit/cluster.hpp"

namespace underbrush::fit {

/// σ of a beam's cross-section at a range (m): horizontal, vertical, m. Empty: thin beams.
using Footprint = std::function<std::array<double, 2>(double range_m)>;

/// Options of `mixture`.
struct MixtureOptions {
  int rounds = 2;           ///< Of expectation and maximisation.
  int shared_by = 3;        ///< Ellipsoids that share a point: those that began nearest to it.
  double least_points = 1;  ///< An ellipsoid that holds fewer in the end is dropped.
  Footprint footprint;
};

/// The ellipsoids of the Gaussian mixture that starts at `clusters`, by expectation–maximisation.
/// A measured point x = y + s is a draw y of the mixture, moved across its beam by s ~ N(0, S), S
/// being the footprint's covariance there: extreme deconvolution, [bovy11] eq. 15–16. So matter
/// comes out as wide as it is, not as wide as the beam that met it. Without a footprint S = 0: the
/// plain mixture, whose ellipsoids share points where clusters part them. Σ is completed and
/// floored as `ellipsoids_of` does, with n + ν for n − 1 + ν. In order of cluster; p_hit is left at
/// 1. `to_sensor` (m) leads from each point to where it was seen from. Throws
/// `std::invalid_argument`.
std::vector<elements::Ellipsoid> mixture(std::span<const Vec3f> points,
                                         std::span<const Vec3f> to_sensor, const Clusters& clusters,
                                         const EllipsoidOptions& ellipsoid,
                                         const MixtureOptions& options);

}  // namespace underbrush::fit
