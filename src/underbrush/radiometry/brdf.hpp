/// \file
/// How surfaces send light back: bidirectional reflectance distribution functions.
#pragma once
#include <cstdint>

#include "underbrush/core/pose.hpp"

namespace underbrush::radiometry {

/// The kinds of surface.
enum class Brdf : uint8_t {
  kLambert,    ///< ρ/π.
  kOrenNayar,  ///< Rough, of Lambertian facets: the qualitative model of [oren94] §4.4.
  kPhong,      ///< Diffuse with a glossy lobe about the mirrored ray: the modified Phong model of
               ///< [lafortune94] eq. 1, which conserves energy.
};

/// A surface, its reflectance ρ apart.
struct SurfaceModel {
  Brdf brdf = Brdf::kLambert;
  double roughness_rad = 0;  ///< Oren–Nayar: σ of the slopes of the facets.
  double gloss = 0;          ///< Phong: share of ρ that goes into the lobe, 0 to 1.
  double exponent = 20;      ///< Phong: n of cosⁿ α.
};

/// f(ω_in, ω_out), 1/sr, of a surface of reflectance 1; 0 where one of the directions is below it.
/// All three vectors are unit; `to_light` and `to_eye` point away from the surface.
double brdf(const SurfaceModel& surface, const Vec3& to_light, const Vec3& to_eye,
            const Vec3& normal);

/// What a lidar gets back, emitter and receiver in one place: π f cos θ, with θ the incidence. A
/// perpendicular Lambertian surface of reflectance 1 has 1. Lambert: cos θ; Oren–Nayar:
/// A cos θ + B sin² θ; Phong: cos θ ((1 − g) + g (n + 2)/2 cosⁿ 2θ).
double backscatter(const SurfaceModel& surface, double cos_incidence);

}  // namespace underbrush::radiometry
