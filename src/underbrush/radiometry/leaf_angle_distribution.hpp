/// \file
/// The distribution of leaf angles, which gives the incidence where a beam ends in an ellipsoid
/// (an ellipsoid has no surface of its own).
#pragma once

namespace underbrush::radiometry {

/// Leaves whose angles are distributed as the surface of a spheroid ([campbell86]), even in azimuth
/// about the vertical. The shape χ is the ratio of its horizontal to its vertical axis: 1 =
/// spherical, any direction alike; large = flat leaves, small = upright ones.
///
/// With n a leaf's normal and d the beam at zenith angle β, over the leaf area:
///
///     G(β) = E|n·d| = √(χ² cos² β + sin² β) / Λ(χ)           the area that 1 m² of leaves shows
///     M(β) = E(n·d)² = cos² β q + ½ sin² β (1 − q),  q = E(n_z)²
///
/// both in closed form. A beam that is stopped by leaves has met them with a density ∝ |n·d|, so
/// that of Lambertian leaves comes back M/G times what a perpendicular one returns: ⅔ for
/// spherical leaves.
class LeafAngleDistribution {
 public:
  /// Throws `std::invalid_argument` unless 0.01 ≤ χ ≤ 100.
  explicit LeafAngleDistribution(double shape = 1);

  /// G, in (0, 1]; `cos_zenith` is that of the beam, up or down.
  double projection(double cos_zenith) const;
  /// M/G, in (0, 1]: the factor for `Receiver::signals`, reflectance apart.
  double backscatter(double cos_zenith) const;
  /// Density of leaf area over the zenith angle of its normal, [0, π/2]: ∫ g dθ = 1.
  double density(double zenith_rad) const;

 private:
  double shape2_, lambda_, vertical2_;  ///< χ², Λ, q.
};

}  // namespace underbrush::radiometry
