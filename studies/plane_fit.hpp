/// \file
/// Planes through points by least squares in the Gauss–Markov model, as [kim12] §3.2.
#pragma once
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::studies {

/// A plane as a height over two horizontal axes, z = a x + b y + c.
struct HeightPlane {
  Vec3 parameters = Vec3::Zero();        ///< ξ = (a, b, c).
  Mat3 covariance = Mat3::Zero();        ///< Of ξ: σ̂₀² (AᵀA)⁻¹.
  double variance = 0;                   ///< σ̂₀² = vᵀv / (n − 3), m².
  double distance(const Vec3& p) const;  ///< Perpendicular, m, positive above.
};

/// The best linear unbiased estimate where only z carries errors, of equal variance: the model of
/// [kim12] table 3. Where x and y carry errors too it is biased towards flat, and much so for a
/// steep plane (`fit_plane`). Throws `std::invalid_argument` for fewer than four points, or for
/// points whose x and y lie on a line.
HeightPlane fit_height_plane(std::span<const Vec3> points);

/// A plane n·p = offset.
struct Plane {
  Vec3 normal = Vec3::UnitZ();  ///< Unit.
  double offset_m = 0;
  Vec3 centre = Vec3::Zero();                 ///< Mean of the points, on the plane.
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY();  ///< Along the plane, with the normal right-handed.
  double variance = 0;                        ///< σ̂₀² of the perpendicular distances, m².
  /// Of (γ, α, β), with which the plane is w = γ + α (u·(p − centre)) + β (v·(p − centre)), w
  /// along the normal: offset m, slopes rad. The estimate itself is zero.
  Mat3 covariance = Mat3::Zero();

  double distance(const Vec3& p) const { return normal.dot(p) - offset_m; }  ///< Signed, m.
};

/// The plane of least perpendicular distances: principal axes, then the Gauss–Markov model in their
/// frame, of which it is the solution. The normal's sign is that which makes its largest component
/// positive. Throws `std::invalid_argument` for fewer than four points or points on a line.
Plane fit_plane(std::span<const Vec3> points);

/// The point that three planes share; throws `std::invalid_argument` where two are parallel.
Vec3 intersection(const Plane& a, const Plane& b, const Plane& c);

}  // namespace underbrush::studies
