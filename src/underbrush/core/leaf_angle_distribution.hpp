/// \file
/// This file models the inclinations of leaves: how many of them a beam of a direction meets, and
/// at which incidence.
#pragma once
#include <cmath>

namespace underbrush {

/// Leaves whose normals are distributed like those of a spheroid's surface [campbell86], evenly in
/// azimuth about the vertical. The shape χ is the ratio of the spheroid's horizontal to its
/// vertical axis: 1 is spherical, with all directions equally likely; large values are flat leaves,
/// small ones upright leaves.
///
/// With n the normal of a leaf and d a beam at zenith angle β, means over the leaf area are
///
///     G(β) = E|n·d| = √(χ² cos² β + sin² β) / Λ(χ)           the projected area of 1 m² of leaves
///     M(β) = E(n·d)² = cos² β q + ½ sin² β (1 − q),  q = E(n_z)²
///
/// both in closed form. A beam that is stopped by leaves hit a leaf with a density ∝ |n·d|.
/// Lambertian leaves therefore return M/G times what a perpendicular one returns, which is ⅔ for
/// spherical leaves.
class LeafAngleDistribution {
 public:
  /// Throws `std::invalid_argument` unless 0.01 ≤ χ ≤ 100.
  explicit LeafAngleDistribution(double shape);
  LeafAngleDistribution() : LeafAngleDistribution(1) {}  ///< Spherical.

  /// χ.
  double shape() const { return std::sqrt(shape2_); }
  bool spherical() const { return shape2_ == 1; }
  /// (2 G)² is level + slope · cos² β; 1 for spherical leaves.
  double level() const { return 4 / (lambda_ * lambda_); }
  double slope() const { return level() * (shape2_ - 1); }
  /// G, in (0, 1]. `cos_zenith` is that of the beam, upwards or downwards.
  double projection(double cos_zenith) const;
  /// M/G, in (0, 1], the factor for `Receiver::signals` without the reflectance.
  double backscatter(double cos_zenith) const;
  /// The density of leaf area over the zenith angle of its normal, in [0, π/2]: ∫ g dθ = 1.
  double density(double zenith_rad) const;

 private:
  double shape2_, lambda_, vertical2_;  ///< χ², Λ, q.
};

}  // namespace underbrush
