#include "underbrush/credit/beta_prior.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
namespace {

struct Drawn {
  std::vector<double> p;
  std::vector<Trials> trials;
};

// Draws from Beta(a, b) by two Gamma variates, each of which is a sum of exponentials for an
// integer parameter.
double beta(int a, int b, Stream& random) {
  double x = 0, y = 0;
  for (int k = 0; k < a; ++k) x -= std::log(random.uniform());
  for (int k = 0; k < b; ++k) y -= std::log(random.uniform());
  return x / (x + y);
}

Drawn draw(int a, int b, int rays, int elements, uint64_t seed) {
  Stream random(seed);
  Drawn out;
  for (int i = 0; i < elements; ++i) {
    const double p = beta(a, b, random);
    Trials t;
    for (int k = 0; k < rays; ++k) ++(random.uniform() < p ? t.hits : t.misses);
    out.p.push_back(p);
    out.trials.push_back(t);
  }
  return out;
}

struct Error {
  double bias = 0, rmse = 0;
};

Error error_of(const Drawn& d, const HitPrior& prior) {
  Error e;
  for (size_t i = 0; i < d.p.size(); ++i) {
    const double x = posterior_mean(d.trials[i], prior) - d.p[i];
    e.bias += x / double(d.p.size());
    e.rmse += x * x / double(d.p.size());
  }
  e.rmse = std::sqrt(e.rmse);
  return e;
}

// Vegetation with p ~ Beta(2, 1) is seen by few rays; the test measures bias and root mean square
// error of p.
TEST(BetaPrior, IsUnbiasedWithFewRaysAndBeatsTheOthers) {
  std::printf(
      "  p ~ Beta(2, 1)   bias / RMSE of p\n  rays   plain           "
      "prior (0, 1)    prior (50, 0)   empirical Bayes\n");
  for (const int rays : {1, 2, 3, 5, 10, 30, 100}) {
    const Drawn d = draw(2, 1, rays, 20000, 42);
    const HitPrior fitted = fit_beta_prior(d.trials);
    const Error plain = error_of(d, {0, 0}), paper = error_of(d, {0, 1}),
                opaque = error_of(d, {50, 0}), bayes = error_of(d, fitted);
    std::printf("  %4d", rays);
    for (const Error& e : {plain, paper, opaque, bayes}) {
      std::printf("  %+.3f / %.3f ", e.bias, e.rmse);
    }
    std::printf("\n");
    EXPECT_LT(std::abs(bayes.bias), 0.005) << rays;
    for (const Error& e : {plain, paper, opaque}) EXPECT_LT(bayes.rmse, e.rmse * 1.001) << rays;
    if (rays <= 10) {
      EXPECT_LT(bayes.rmse, 0.9 * std::min(plain.rmse, opaque.rmse)) << rays;
    }
  }
}

TEST(BetaPrior, RecoversWhatMadeTheTrials) {
  for (const auto& [a, b] : {std::pair(1, 1), std::pair(2, 1), std::pair(6, 2)}) {
    const HitPrior prior = fit_beta_prior(draw(a, b, 12, 20000, 7).trials);
    EXPECT_NEAR(prior.a, a, 0.08 * a) << a << " " << b;
    EXPECT_NEAR(prior.b, b, 0.08 * b) << a << " " << b;
  }
}

// The log-marginal likelihood is computed the slow way, and the fit must be at its maximum.
TEST(BetaPrior, HasTheGreatestMarginalLikelihood) {
  const Drawn d = draw(3, 2, 6, 2000, 3);
  const auto likelihood = [&](double a, double b) {
    double sum = 0;
    for (const Trials& t : d.trials) {
      sum += std::lgamma(t.hits + a) + std::lgamma(t.misses + b) -
             std::lgamma(t.hits + t.misses + a + b) - std::lgamma(a) - std::lgamma(b) +
             std::lgamma(a + b);
    }
    return sum;
  };
  const HitPrior best = fit_beta_prior(d.trials);
  const double top = likelihood(best.a, best.b);
  for (const double by : {0.97, 1.03}) {
    EXPECT_LT(likelihood(best.a * by, best.b), top);
    EXPECT_LT(likelihood(best.a, best.b * by), top);
    EXPECT_LT(likelihood(best.a * by, best.b * by), top);
  }
}

TEST(BetaPrior, OfOneSidedOrNoTrialsIsClear) {
  EXPECT_NEAR(fit_beta_prior({}).mean(), 1, 0.01);
  const std::vector<Trials> unseen(10), hits(100, {5, 0}), misses(100, {0, 5}), same(100, {2, 2});
  EXPECT_NEAR(fit_beta_prior(unseen).mean(), 1, 0.01);
  EXPECT_GT(fit_beta_prior(hits).mean(), 0.95);
  EXPECT_LT(fit_beta_prior(misses).mean(), 0.05);
  const HitPrior prior = fit_beta_prior(same);
  EXPECT_NEAR(prior.mean(), 0.5, 1e-3);
  EXPECT_LE(prior.a + prior.b, 1.0001e4);
}

}  // namespace
}  // namespace underbrush::credit
