/// \file
/// Leaf-angle distributions: how steeply leaves stand.
#pragma once
#include <cstdint>

namespace underbrush::test_site {

/// The classic one-parameter-free densities g(θ) of the zenith angle θ ∈ [0, π/2] of leaf normals
/// ([dewit65]); ∫ g dθ = 1.
enum class LeafAngle : uint8_t {
  kSpherical,     ///< sin θ: normals uniform on the sphere.
  kUniform,       ///< 2/π.
  kPlanophile,    ///< (2/π)(1 + cos 2θ): mostly flat.
  kErectophile,   ///< (2/π)(1 − cos 2θ): mostly upright.
  kPlagiophile,   ///< (2/π)(1 − cos 4θ): mostly at 45°.
  kExtremophile,  ///< (2/π)(1 + cos 4θ): flat or upright.
};

/// g(θ), 1/rad.
double leaf_angle_density(LeafAngle angles, double zenith_rad);
/// ∫₀^θ g.
double leaf_angle_cdf(LeafAngle angles, double zenith_rad);
/// The zenith angle (rad) below which a fraction `u` ∈ (0, 1) of the leaf area stands.
double leaf_angle_quantile(LeafAngle angles, double u);

/// Ross's G: mean area that one m² of leaves (uniform in azimuth) shows to a beam at zenith angle
/// β; the gap fraction of a turbid crown is exp(−G·λ·path) with λ in m² leaf per m³ ([ross81]).
double leaf_projection(LeafAngle angles, double beam_zenith_rad);

}  // namespace underbrush::test_site
