/// \file
/// Leaf-angle distributions: the probability of the inclination of leaves.
#pragma once
#include <cstdint>

namespace underbrush::test_site {

/// The classic densities g(θ) without free parameters, where θ ∈ [0, π/2] is the zenith angle of a
/// leaf's normal ([dewit65]); ∫ g dθ = 1.
enum class LeafAngle : uint8_t {
  kSpherical,     ///< sin θ: normals are uniform on the sphere.
  kUniform,       ///< 2/π.
  kPlanophile,    ///< (2/π)(1 + cos 2θ): leaves are mostly flat.
  kErectophile,   ///< (2/π)(1 − cos 2θ): leaves are mostly upright.
  kPlagiophile,   ///< (2/π)(1 − cos 4θ): leaves are mostly at 45°.
  kExtremophile,  ///< (2/π)(1 + cos 4θ): leaves are flat or upright.
};

/// Returns the density g(θ) (1/rad).
double leaf_angle_density(LeafAngle angles, double zenith_rad);
/// Returns the cumulative distribution ∫₀^θ g.
double leaf_angle_cdf(LeafAngle angles, double zenith_rad);
/// Returns the zenith angle (rad) below which a fraction `u` ∈ (0, 1) of the leaf area lies.
double leaf_angle_quantile(LeafAngle angles, double u);

/// Returns Ross's G: the mean area that one m² of leaves (uniform in azimuth) shows to a beam at
/// the zenith angle β. The gap fraction of a turbid crown is exp(−G·λ·path), with λ in m² of leaves
/// per m³ ([ross81]).
double leaf_projection(LeafAngle angles, double beam_zenith_rad);

}  // namespace underbrush::test_site
