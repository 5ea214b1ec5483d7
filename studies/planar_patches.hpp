/// \file
/// Planar patches found in a cloud.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "studies/plane_fit.hpp"

namespace underbrush::studies {

/// A plane, the points on it and the convex outline that they fill.
struct PlanarPatch {
  Plane plane;
  std::vector<uint32_t> points;  ///< Indices into the cloud.
  std::vector<Vec3> outline;     ///< Corners, counter-clockwise about the normal.
};

/// How patches are sought.
struct PatchOptions {
  int neighbours = 15;
  double most_angle_rad = 0.2;    ///< Between a point's normal and the plane's.
  double most_distance_m = 0.06;  ///< From the plane.
  double most_gap_m = 0.4;        ///< To the next point of the patch.
  size_t least_points = 300;
  size_t most_patches = 9;
};

/// Grows patches from the points whose surroundings are flattest, over neighbours near the plane
/// and turned alike; the plane is fitted anew as the patch doubles. The largest come first. `cloud`
/// in metres; keep it near its origin.
std::vector<PlanarPatch> planar_patches(std::span<const Vec3f> cloud, const PatchOptions& options);

}  // namespace underbrush::studies
