/// \file
/// Planes fitted to points by least squares in the Gauss–Markov model, as in [kim12] §3.2.
#pragma once
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::studies {

/// Returns the mean of one point or more.
Vec3 mean_of(std::span<const Vec3> points);

/// A plane as a height over two horizontal axes, z = a x + b y + c.
struct HeightPlane {
  Vec3 parameters = Vec3::Zero();        ///< ξ = (a, b, c).
  Mat3 covariance = Mat3::Zero();        ///< Covariance of ξ: σ̂₀² (AᵀA)⁻¹.
  double variance = 0;                   ///< σ̂₀² = vᵀv / (n − 3), m².
  double distance(const Vec3& p) const;  ///< Perpendicular distance (m), positive above the plane.
};

/// Returns the best linear unbiased estimate for points of which only z has errors, of equal
/// variance; this is the model of [kim12] table 3. Where x and y have errors too, the estimate is
/// biased towards flat planes, strongly so for a steep plane; `fit_plane` is not. Throws
/// `std::invalid_argument` for fewer than four points, or for points whose x and y lie on a line.
HeightPlane fit_height_plane(std::span<const Vec3> points);

/// A plane n·p = offset.
struct Plane {
  Vec3 normal = Vec3::UnitZ();  ///< Unit vector.
  double offset_m = 0;
  Vec3 centre = Vec3::Zero();  ///< Mean of the points, on the plane.
  /// Unit vectors along the plane; u, v and the normal are right-handed.
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY();
  double variance = 0;  ///< σ̂₀² of the perpendicular distances, m².
  /// Covariance of (γ, α, β), with which the plane is w = γ + α (u·(p − centre)) + β (v·(p −
  /// centre)), where w is along the normal; the offset is in m, the slopes are in rad. The estimate
  /// itself is zero.
  Mat3 covariance = Mat3::Zero();

  /// Signed distance, m.
  double distance(const Vec3& p) const { return normal.dot(p) - offset_m; }
};

/// Returns the plane of least perpendicular distances, by principal axes; it solves the
/// Gauss–Markov model in their frame, which gives the covariance. The sign of the normal makes its
/// largest component positive. Throws `std::invalid_argument` for fewer than four points or points
/// on a line.
Plane fit_plane(std::span<const Vec3> points);

/// Returns the point that three planes share. Throws `std::invalid_argument` where two are
/// parallel.
Vec3 intersection(const Plane& a, const Plane& b, const Plane& c);

}  // namespace underbrush::studies
