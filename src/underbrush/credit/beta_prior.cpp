#include "underbrush/credit/beta_prior.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace underbrush::credit {
namespace {

constexpr double kLeast = 1e-3, kMost = 1e4;

// The digamma function ψ(x), x > 0. The recurrence raises x to where the asymptotic series is exact
// to 1e-10.
double digamma(double x) {
  double out = 0;
  for (; x < 8; ++x) out -= 1 / x;
  const double y = 1 / (x * x);
  return out + std::log(x) - 0.5 / x -
         y * (1.0 / 12 - y * (1.0 / 120 - y * (1.0 / 252 - y * (1.0 / 240 - y / 132))));
}

HitPrior limited(double a, double b) {
  const double shrink = std::min(1.0, kMost / (a + b));
  return {std::clamp(a * shrink, kLeast, kMost), std::clamp(b * shrink, kLeast, kMost)};
}

// Estimates the prior from the mean m and the variance of the shares hits / n, by Var = m (1 − m)
// (1 + (n − 1) r) / n with r = 1 / (a + b + 1).
HitPrior by_moments(std::span<const Trials> trials) {
  double hits = 0, n = 0;
  for (const Trials& t : trials) {
    hits += t.hits;
    n += double(t.hits) + t.misses;
  }
  const double mean = std::clamp(hits / n, 1e-3, 1 - 1e-3);
  double squares = 0, expected = 0, slope = 0;
  for (const Trials& t : trials) {
    const double k = double(t.hits) + t.misses;
    if (k < 2) continue;
    squares += (t.hits / k - mean) * (t.hits / k - mean);
    expected += mean * (1 - mean) / k;
    slope += mean * (1 - mean) * (k - 1) / k;
  }
  const double r = slope > 0 ? std::clamp((squares - expected) / slope, 0.01, 0.9) : 0.5;
  const double strength = 1 / r - 1;
  return limited(mean * strength, (1 - mean) * strength);
}

}  // namespace

double posterior_mean(const Trials& trials, const HitPrior& prior) {
  const double n = double(trials.hits) + trials.misses + prior.a + prior.b;
  return n > 0 ? (trials.hits + prior.a) / n : 1;
}

HitPrior fit_beta_prior(std::span<const Trials> trials) {
  std::vector<Trials> seen;
  for (const Trials& t : trials) {
    if (t.hits || t.misses) seen.push_back(t);
  }
  if (seen.empty()) return {1, kLeast};
  HitPrior prior = by_moments(seen);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const auto [a, b] = prior;
    const double at_a = digamma(a), at_b = digamma(b), at_n = digamma(a + b);
    double hits = 0, misses = 0, all = 0;
    for (const Trials& t : seen) {
      if (t.hits) hits += digamma(t.hits + a) - at_a;
      if (t.misses) misses += digamma(t.misses + b) - at_b;
      all += digamma(double(t.hits) + t.misses + a + b) - at_n;
    }
    prior = limited(a * hits / all, b * misses / all);
    if (std::abs(prior.a - a) < 1e-4 * a && std::abs(prior.b - b) < 1e-4 * b) break;
  }
  return prior;
}

}  // namespace underbrush::credit
