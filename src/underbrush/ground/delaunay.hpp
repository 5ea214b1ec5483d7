/// \file
/// Delaunay triangulation of the plane.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace underbrush::ground {

/// Triangles (indices into `points`, counter-clockwise) that cover the points' convex hull, no point
/// inside any circumcircle. Of points at the same place one is used; points on one circle (a grid's)
/// are split one way or another, always the same. No triangles for fewer than three points or when
/// all lie on a line. Throws `std::invalid_argument` for a point that is not finite.
std::vector<std::array<uint32_t, 3>> delaunay(std::span<const Eigen::Vector2d> points);

}  // namespace underbrush::ground
