/// \file
/// This file estimates probabilities from few trials: it has the Beta prior and its fit to many
/// small counts.
#pragma once
#include <cstdint>
#include <span>

namespace underbrush::credit {

/// A Beta prior, written as the hits a and misses b that count before any beam was seen: p_hit =
/// (hits + a) / (hits + misses + a + b).
struct HitPrior {
  double a = 0, b = 1;
  /// The mean of p without any trial; 1 where a = b = 0.
  double mean() const { return a + b > 0 ? a / (a + b) : 1; }
};

/// The hits and misses of one element.
struct Trials {
  uint32_t hits = 0, misses = 0;
};

/// Computes the mean of p after the trials: (hits + a) / (hits + misses + a + b), or 1 where that
/// is 0 / 0.
double posterior_mean(const Trials& trials, const HitPrior& prior);

/// Fits a Beta prior to the trials of many elements. It is the Beta(a, b) of greatest marginal
/// likelihood under the Beta-binomial distribution, ∏ B(h + a, m + b) / B(a, b), found by Minka's
/// fixed-point iteration from the moments of the trials.
///
/// Elements without a trial have no effect. If the elements are draws from one Beta distribution,
/// posterior means under the fitted prior are unbiased however few trials each has. The result has
/// a, b ≥ 0.001 and a + b ≤ 10 000, limits that trials of equal shares or of hits alone would
/// exceed. It is (1, 0.001), nearly opaque, where there are no trials.
HitPrior fit_beta_prior(std::span<const Trials> trials);

}  // namespace underbrush::credit
