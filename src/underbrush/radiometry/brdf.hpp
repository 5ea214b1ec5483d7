/// \file
/// This file has bidirectional reflectance distribution functions, which describe the reflection of
/// light by surfaces.
#pragma once
#include <cstdint>

#include "underbrush/core/pose.hpp"

namespace underbrush::radiometry {

/// The kinds of surface.
enum class Brdf : uint8_t {
  kLambert,    ///< ρ/π.
  kOrenNayar,  ///< Rough, made of Lambertian facets: the qualitative model of [oren94] §4.4.
  kPhong,      ///< Diffuse with a glossy lobe about the mirrored ray: the modified Phong model of
               ///< [lafortune94] eq. 1, which conserves energy.
};

/// The reflection of a surface without its reflectance ρ.
struct SurfaceModel {
  Brdf brdf = Brdf::kLambert;
  double roughness_rad = 0;  ///< For Oren–Nayar: σ of the slopes of the facets.
  double gloss = 0;          ///< For Phong: share of ρ in the lobe, 0 to 1.
  double exponent = 20;      ///< For Phong: n of cosⁿ α.
};

/// Computes f(ω_in, ω_out), 1/sr, of a surface of reflectance 1. All three vectors are unit
/// vectors; `to_light` and `to_eye` point away from the surface. It is 0 where one of them is below
/// the surface.
double brdf(const SurfaceModel& surface, const Vec3& to_light, const Vec3& to_eye,
            const Vec3& normal);

/// Computes the light that a lidar gets back, with emitter and receiver in one place: π f cos θ at
/// the angle of incidence θ. A perpendicular Lambertian surface of reflectance 1 gives 1. Lambert
/// gives cos θ, Oren–Nayar A cos θ + B sin² θ, and Phong cos θ ((1 − g) + g (n + 2)/2 cosⁿ 2θ).
double backscatter(const SurfaceModel& surface, double cos_incidence);

}  // namespace underbrush::radiometry
