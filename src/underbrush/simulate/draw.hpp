/// \file
/// This file draws the range of a beam that ends at an element.
#pragma once
#include <algorithm>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// Returns `t` (m), or the element's own range where `t` lies outside `limits`.
inline double within(double t, const trace::Intersection& met, const trace::RangeLimits& limits) {
  return t >= limits.min_m && t <= limits.max_m ? t : met.t_m;
}

/// Draws t ~ N(t_i, σ_i²) along the ray, [deschaud12] eq. 2–3, with the random numbers of `key`; m.
inline double drawn_on_ray(const trace::Intersection& met, uint64_t key,
                           const trace::RangeLimits& limits) {
  if (met.sigma_m == 0) return met.t_m;
  return within(met.t_m + met.sigma_m * normal(key, met.element, Purpose::kRange), met, limits);
}

/// The key of matter that is drawn once for all beams.
constexpr uint64_t matter_key(uint64_t seed) { return mix64(seed ^ 0x6d61747465720000ull); }

/// The key of matter at a time: where it sways, with its correlation time in seconds, the upper
/// half of the key is the time (`trace::Draws::kSwaying`).
inline uint64_t matter_at(uint64_t matter, double time_s, double sway_s) {
  if (sway_s == 0) return matter;
  return uint64_t(trace::ticks_of(time_s, sway_s)) << 32 | uint32_t(matter);
}

/// The part of an element's σ (m) that is its matter's, where `noise_m` is the sensor's part.
inline double matter_sigma(double sigma_m, double noise_m) {
  return std::sqrt(std::max(0.0, sigma_m * sigma_m - noise_m * noise_m));
}

/// Draws the range of a beam where the matter is drawn once, as N(t_i, σ_i²) over seeds: the depth
/// of the matter has the key `matter`, of its instance and its cell, and the sensor's noise the key
/// of the beam; m.
inline double drawn_in_matter(const trace::Intersection& met, uint64_t matter, uint64_t beam,
                              double noise_m, const trace::RangeLimits& limits) {
  if (met.sigma_m == 0) return met.t_m;
  const double t =
      met.t_m + matter_sigma(met.sigma_m, noise_m) * normal(matter, met.element, Purpose::kRange) +
      std::min(met.sigma_m, noise_m) * normal(beam, met.element, Purpose::kRange);
  return within(t, met, limits);
}

/// Draws the range as above from the random bits themselves, by the faster `QuickNormal`, whose
/// numbers err by up to 2e-4 σ. It serves beams of many sub-rays.
inline double drawn_on_ray(const trace::Intersection& met, uint64_t bits,
                           const trace::RangeLimits& limits, const QuickNormal& normal) {
  if (met.sigma_m == 0) return met.t_m;
  return within(met.t_m + met.sigma_m * normal(bits), met, limits);
}

}  // namespace underbrush::simulate
