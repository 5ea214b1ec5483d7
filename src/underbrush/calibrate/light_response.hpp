/// \file
/// The two parts of learning light: the reflectance of each element, and the response that all
/// returns of a log share.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/elements/light.hpp"

namespace underbrush::calibrate {

/// The sums over the returns of an element, each with the intensity I and the response k.
struct LightSums {
  double response = 0;   ///< Σ k.
  double intensity = 0;  ///< Σ I.
  double squares = 0;    ///< Σ I²/k.
  uint32_t returns = 0;

  void add(double intensity_of_one, double response_of_one);
};

/// Estimates the reflectance of each element by the credibility of [buhlmann70]. Elements are
/// random draws of their group (`group[e]` < `groups`), whose mean is m and whose variance is τ²;
/// a return has the mean k ρ and the variance k s². The best linear estimate is
///   ρ = (Σ I + λ m) / (Σ k + λ),   λ = s² / τ²,
/// which is the group's mean for an element without returns. The spread is √v with the variance
/// v of I/k within the element, weighted by k, of which the group's counts as much as 8 returns.
/// A group whose τ² cannot be estimated has the λ of all elements together. With `pooled`, every
/// element has the mean of its group.
std::vector<elements::Reflectance> reflectances(std::span<const LightSums> sums,
                                                std::span<const uint32_t> group, size_t groups,
                                                bool pooled = false);

/// A return of which the element is known.
struct LightSample {
  uint32_t element = 0;
  float intensity = 0, range_m = 0;
  float cosine = 0;  ///< `elements::incidence_cosine`.
  uint16_t ring = 0;
  bool is_ellipsoid = false;
};

/// Fits the factors of `elements::Light` (all but `max_intensity`) to returns. The model
/// I = ρ f(r) g(c) h(n) is that of a Poisson regression with a logarithmic link, except that gains
/// between knots are linear, and elements have the estimate of `reflectances`. Factors are
/// estimated in turn, each by the step of [richardson72], which raises the likelihood,
///   f_b = Σ a_b min(I/Î, 4) + λ  over  Σ a_b / f_b + λ,
/// where a_b is the part of the prediction Î that knot b has. The bound keeps retroreflectors from
/// deciding, and λ is 20 mean returns, by which a knot of few returns has the gain 1. The first
/// rounds use the groups only, so that effects shared by all elements belong to the response.
elements::Light fit_response(std::span<const LightSample> samples, std::span<const uint32_t> group,
                             size_t groups);

}  // namespace underbrush::calibrate
