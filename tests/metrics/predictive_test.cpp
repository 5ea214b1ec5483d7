#include "underbrush/metrics/predictive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::metrics {
namespace {

using trace::mix_ranges;
using trace::RangeMixture;

RangeMixture random_mixture(Stream& random) {
  RangeMixture p;
  p.miss = 1;
  double t = 2;
  for (int k = 0; k < 5; ++k) {
    const double hit = random.uniform();
    t += random.uniform(0, 10);
    p.components.push_back({p.miss * hit, t, random.uniform(0.05, 2)});
    p.miss *= 1 - hit;
  }
  return p;
}

double draw(const RangeMixture& p, Stream& random, double max_range) {
  double u = random.uniform();
  for (const auto& c : p.components) {
    if ((u -= c.weight) < 0) return c.t_m + c.sigma_m * random.normal();
  }
  return max_range;
}

TEST(Predict, WeightsAreTrialsInOrderAndSumToOne) {
  std::vector<trace::Intersection> met;
  for (uint32_t k = 0; k < 3; ++k) met.push_back({10.0 + k, 0.1, 0, 0.5, k});
  RangeMixture p;
  mix_ranges(met, 1, 0, p);
  ASSERT_EQ(p.components.size(), 3u);
  EXPECT_DOUBLE_EQ(p.components[2].weight, 0.125);
  EXPECT_DOUBLE_EQ(p.miss, 0.125);
}

TEST(NegativeLogLikelihood, IsThatOfANormalizedDensity) {
  Stream random(3);
  const RangeMixture p = random_mixture(random);
  double total = std::exp(-negative_log_likelihood(p, kMiss, 100));
  for (double z = -20; z < 120; z += 0.002) {
    // Outliers have no share outside [0, 100], where their density must be subtracted.
    const double density = std::exp(-negative_log_likelihood(p, z, 100));
    total += 0.002 * (density - (z < 0 || z > 100 ? trace::kReportedOutliers.hit / 100 : 0));
  }
  EXPECT_NEAR(total, 1, 1e-4);
}

TEST(NegativeLogLikelihood, OfAnUnexplainedBeamIsFinite) {
  EXPECT_NEAR(negative_log_likelihood({}, 50, 100), -std::log(trace::kReportedOutliers.hit / 100),
              1e-12);
  RangeMixture sure;
  sure.miss = 0;
  sure.components = {{1, 10, 0.1}};
  EXPECT_NEAR(negative_log_likelihood(sure, kMiss, 100), -std::log(trace::kReportedOutliers.miss),
              1e-12);
}

// The score is compared with a simulation of E|X − z| − ½ E|X − X'|.
TEST(Crps, EqualsItsDefinitionByMonteCarlo) {
  Stream random(4);
  for (int trial = 0; trial < 5; ++trial) {
    const RangeMixture p = random_mixture(random);
    const double z = trial == 4 ? 100 : random.uniform(0, 40);
    double to_z = 0, among = 0;
    const int n = 200000;
    for (int i = 0; i < n; ++i) {
      const double a = draw(p, random, 100), b = draw(p, random, 100);
      to_z += std::abs(a - z) / n;
      among += std::abs(a - b) / n;
    }
    EXPECT_NEAR(crps(p, trial == 4 ? double(kMiss) : z, 100), to_z - 0.5 * among, 0.3);
  }
}

TEST(Crps, OfAPointForecastIsTheAbsoluteError) {
  RangeMixture p;
  p.miss = 0;
  p.components = {{1, 10, 0}};
  EXPECT_DOUBLE_EQ(crps(p, 13, 100), 3);
}

// The closed form for a single Gaussian is [gneiting07] eq. 21.
TEST(Crps, OfAGaussianInClosedForm) {
  for (const double sigma : {0.02, 0.3, 4.0}) {
    const RangeMixture p{{{1, 20, sigma}}, 0};
    for (double x = -12; x < 12; x += 0.0371) {
      const double phi = std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI);
      const double expected = sigma * (x * std::erf(x / M_SQRT2) + 2 * phi - 1 / std::sqrt(M_PI));
      ASSERT_NEAR(crps(p, 20 + sigma * x, 100), expected, 1e-10 * sigma) << x;
    }
  }
}

TEST(Crps, IsProperTheTruthScoresBest) {
  Stream random(8);
  const RangeMixture truth = random_mixture(random);
  RangeMixture shifted = truth, vague = truth, sure = truth;
  for (auto& c : shifted.components) c.t_m += 1;
  for (auto& c : vague.components) c.sigma_m *= 3;
  sure.miss = 0;
  for (auto& c : sure.components) c.weight /= 1 - truth.miss;
  double s_truth = 0, s_shifted = 0, s_vague = 0, s_sure = 0;
  for (int i = 0; i < 20000; ++i) {
    const double z = draw(truth, random, 100), r = z == 100 ? double(kMiss) : z;
    s_truth += crps(truth, r, 100);
    s_shifted += crps(shifted, r, 100);
    s_vague += crps(vague, r, 100);
    s_sure += crps(sure, r, 100);
  }
  EXPECT_LT(s_truth, s_shifted);
  EXPECT_LT(s_truth, s_vague);
  EXPECT_LT(s_truth, s_sure);
}

}  // namespace
}  // namespace underbrush::metrics
