/// \file
/// This file draws the range of a beam that ends at an element.
#pragma once
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// Gives `t` (m), or the element's own range where `t` lies outside `limits`.
inline double within(double t, const trace::Intersection& met, const trace::RangeLimits& limits) {
  return t >= limits.min_m && t <= limits.max_m ? t : met.t_m;
}

/// Draws t ~ N(t_i, σ_i²) along the ray, [deschaud12] eq. 2–3, with the random numbers of `key`; m.
inline double drawn_on_ray(const trace::Intersection& met, uint64_t key,
                           const trace::RangeLimits& limits) {
  if (met.sigma_m == 0) return met.t_m;
  return within(met.t_m + met.sigma_m * normal(key, met.element, Purpose::kRange), met, limits);
}

/// Draws the range as above from the random bits themselves, by the faster `QuickNormal`, whose
/// numbers err by up to 2e-4 σ. It serves beams of many sub-rays.
inline double drawn_on_ray(const trace::Intersection& met, uint64_t bits,
                           const trace::RangeLimits& limits, const QuickNormal& normal) {
  if (met.sigma_m == 0) return met.t_m;
  return within(met.t_m + met.sigma_m * normal(bits), met, limits);
}

}  // namespace underbrush::simulate
