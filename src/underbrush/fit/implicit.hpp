/// \file
/// Implicit surfaces through oriented points: functions whose zero set is the surface.
#pragma once
#include <functional>
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::fit {

/// A point of the surface with the unit normal of its neighbourhood, towards the sensor.
struct OrientedPoint {
  Vec3f position = Vec3f::Zero();  ///< m.
  Vec3f normal = Vec3f::Zero();
  float radius_m = 0;  ///< How far it has a say.
};

/// Weight of a point at `x`: (1 − |x − p|²/r²)⁴ within its radius r, zero beyond [oztireli09].
float weight(const Vec3f& x, const OrientedPoint& point);

/// Signed distance (m, positive on the sensor's side) of `x` to the surface of the points `near`,
/// which are all those nearer than their radius; NaN where there is none.
using SignedDistance = std::function<float(const Vec3f& x, std::span<const OrientedPoint> near)>;

/// Implicit moving least squares: f(x) = Σ wᵢ nᵢ·(x − pᵢ) / Σ wᵢ.
float imls(const Vec3f& x, std::span<const OrientedPoint> near);

/// Its robust version [oztireli09], which keeps edges: f is fitted again, up to eight times, with
/// each weight multiplied by exp(−(rᵢ/σ_r)²) exp(−(|nᵢ − ∇f|/σ_n)²), rᵢ = nᵢ·(x − pᵢ) − f. σ_n =
/// 0.75; σ_r is a quarter of the points' mean radius (the authors: half their spacing).
float rimls(const Vec3f& x, std::span<const OrientedPoint> near);

}  // namespace underbrush::fit
