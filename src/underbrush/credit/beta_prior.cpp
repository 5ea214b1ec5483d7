#include "underbrush/credit/beta_prior.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace underbrush::credit {
double posterior_mean(const Trials& trials, const HitPrior& prior) {
  const double n = double(trials.hits) + trials.misses + prior.a + prior.b;
  return n > 0 ? (trials.hits + prior.a) / n : 1;
}

}  // namespace underbrush::credit
