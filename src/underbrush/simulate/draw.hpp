/// \file
/// The range of a beam that ends at an element.
#pragma once
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::simulate {

/// t ~ N(t_i, σ_i²) along the ray, [deschaud12] eq. 2–3; a draw outside `limits` becomes the
/// element itself.
inline double drawn_on_ray(const trace::Met& met, uint64_t key, const trace::RangeLimits& limits) {
  if (met.sigma_m == 0) return met.t_m;
  const double t = met.t_m + met.sigma_m * normal(key, met.element, Purpose::kRange);
  return t >= limits.min_m && t <= limits.max_m ? t : met.t_m;
}

}  // namespace underbrush::simulate
