#include "underbrush/fit/change.hpp"

#include <cmath>

namespace underbrush::fit {
namespace {

struct Counts {
  double hits = 0, misses = 0;
};

Counts independent(const Trials& t) {
  const double n = double(t.hits) + t.misses;
  const double share = n > 0 ? 1 / (1 + (n - 1) * kTrialCorrelation) : 0;
  return {t.hits * share, t.misses * share};
}

/// log B(h + 1, m + 1).
double log_marginal(const Counts& c) {
  int sign = 0;  // lgamma() itself writes a variable that threads share
  return lgamma_r(c.hits + 1, &sign) + lgamma_r(c.misses + 1, &sign) -
         lgamma_r(c.hits + c.misses + 2, &sign);
}

}  // namespace

double change_evidence(const Trials& earlier, const Trials& later) {
  const Counts a = independent(earlier), b = independent(later);
  return log_marginal(a) + log_marginal(b) -
         log_marginal({a.hits + b.hits, a.misses + b.misses});
}

CurrentTrials with_later(const Trials& earlier, const Trials& later) {
  if (change_evidence(earlier, later) > kChangeEvidence) return {later, true};
  return {{earlier.hits + later.hits, earlier.misses + later.misses}, false};
}

}  // namespace underbrush::fit
