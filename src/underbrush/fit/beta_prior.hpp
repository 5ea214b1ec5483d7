/// \file
/// Probabilities from few trials: the Beta prior, and its fit to many small counts.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::fit {

/// Counts before any beam was seen: p_hit = (hits + a) / (hits + misses + a + b).
struct HitPrior {
  double a = 0, b = 1;
  double mean() const { return a + b > 0 ? a / (a + b) : 1; }
};

/// Hits and misses of one element.
struct Trials {
  uint32_t hits = 0, misses = 0;
};

/// The mean of p after the trials; 1 where neither prior nor trials say anything.
double posterior_mean(const Trials& trials, const HitPrior& prior);

/// The Beta(a, b) of greatest marginal likelihood of the trials,
/// ∏ B(h + a, m + b) / B(a, b) (the Beta-binomial; Minka's fixed point from a start by moments).
/// Trials of no beam say nothing. Posterior means are then right on average over the elements,
/// however few trials each has, where one prior made them all. a, b ≥ 0.001, a + b ≤ 10 000 (all
/// alike, or all hits). (1, 0.001) where there are no trials: opaque, as good as.
HitPrior fit_beta_prior(std::span<const Trials> trials);

}  // namespace underbrush::fit
