/// \file
/// This file has implicit surfaces through oriented points: functions whose zero set is the
/// surface.
#pragma once
#include <functional>
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::surface {

/// A point of the surface with the unit normal of its neighbourhood, which points towards the
/// sensor.
struct OrientedPoint {
  Vec3f position = Vec3f::Zero();  ///< m.
  Vec3f normal = Vec3f::Zero();
  float radius_m = 0;  ///< Radius within which the point has weight, m.
};

/// Computes the weight of a point at `x`: (1 − |x − p|²/r²)⁴ within its radius r, 0 beyond
/// [oztireli09].
float weight(const Vec3f& x, const OrientedPoint& point);

/// A function that computes the signed distance of `x` to the surface (m, positive on the sensor's
/// side). `near` has all points that are nearer to `x` than their radius. It gives NaN where there
/// are none.
using SignedDistance = std::function<float(const Vec3f& x, std::span<const OrientedPoint> near)>;

/// Computes implicit moving least squares, f(x) = Σ wᵢ nᵢ·(x − pᵢ) / Σ wᵢ.
float imls(const Vec3f& x, std::span<const OrientedPoint> near);

/// Computes robust implicit moving least squares [oztireli09], which keeps edges sharp. f is fitted
/// up to eight times; each time the weights are multiplied by exp(−(rᵢ/σ_r)²) exp(−(|nᵢ −
/// ∇f|/σ_n)²) with the residual rᵢ = nᵢ·(x − pᵢ) − f of the last fit. σ_n is 0.75, and σ_r is a
/// quarter of the points' mean radius, where the authors take half the points' spacing.
float rimls(const Vec3f& x, std::span<const OrientedPoint> near);

}  // namespace underbrush::surface
