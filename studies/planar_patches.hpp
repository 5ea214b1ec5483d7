/// \file
/// Search for planar patches in a cloud.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "studies/plane_fit.hpp"

namespace underbrush::studies {

/// A plane, the points on it and their convex outline.
struct PlanarPatch {
  Plane plane;
  std::vector<uint32_t> points;  ///< Indices into the cloud.
  std::vector<Vec3> outline;     ///< Corners, counter-clockwise about the normal.
};

/// Options of `planar_patches`.
struct PatchOptions {
  int neighbours = 15;
  double most_angle_rad = 0.2;    ///< Angle between a point's normal and the plane's.
  double most_distance_m = 0.06;  ///< Distance from the plane.
  double most_gap_m = 0.4;        ///< Distance to the next point of the patch.
  size_t least_points = 300;
  size_t most_patches = 9;
};

/// Finds planar patches, the largest first. A patch grows from the points with the flattest
/// surroundings over neighbours that lie near the plane and have a similar normal; the plane is
/// fitted again each time the patch has doubled. `cloud` is in metres and should lie near its
/// origin. Throws `std::invalid_argument` for too few neighbours or points.
std::vector<PlanarPatch> planar_patches(std::span<const Vec3f> cloud, const PatchOptions& options);

}  // namespace underbrush::studies
