/// \file
/// Hit probabilities from few trials, by a Beta prior.
#pragma once
#include <cstdint>

namespace underbrush::credit {

/// A Beta prior, written as the hits a and misses b that count before any beam: p_hit = (hits + a)
/// / (hits + misses + a + b).
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

}  // namespace underbrush::credit
