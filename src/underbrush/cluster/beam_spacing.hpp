/// \file
/// The angles between the neighbouring beams of a log, and the extent of matter that they leave
/// open.
#pragma once
#include <span>
#include <vector>

#include "underbrush/cluster/cluster.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::cluster {

/// The median angles between neighbouring beams of a scan, rad; 0 where there are none.
struct BeamSpacing {
  double in_ring = 0;  ///< From a beam to the nearest direction of its ring.
  /// From a beam to the rings above and below, the mean of both; as `in_ring` where a scan has one
  /// ring or its rings are not distinguished.
  double from_ring = 0;
  bool operator==(const BeamSpacing&) const = default;
};

/// Measures the spacing in the first scans of a log, of about 500 000 rows at most. The order of
/// the beams of a scan does not matter. A ring is taken for a cone about the world's z-axis, and
/// angles over 5° do not count, because no sensor scans so coarsely.
BeamSpacing beam_spacing(BeamSource& log);

/// The covariances, m², that the ellipsoids of clusters have at least because nothing is known
/// between the beams. Matter that a beam met is taken to reach half way to its neighbours, evenly,
/// so that the variances along and across its ring are (r a)²/12 with the range r and the angle a
/// between the beams, averaged over the points. The beams of further places (within 25 cm) of the
/// sensor may fall into the gaps: beams that divide a gap into the parts g_k of it reduce the
/// variance in that direction to Σ g_k³. Beams that fall on those of other places, as the rings of
/// a sensor do that drives along a wall, do not. `points` and `to_sensor` are as in
/// `VolumetricPoints`. The result has one entry for each cluster that has points, in their order.
std::vector<Eigen::Matrix3f> open_covariances(std::span<const Vec3f> points,
                                              std::span<const Vec3f> to_sensor,
                                              const Clusters& clusters, const BeamSpacing& spacing);

}  // namespace underbrush::cluster
