#include "underbrush/metrics/intensity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/metrics/score.hpp"

namespace underbrush::metrics {
namespace {

BeamLog log_with_intensities(const std::vector<float>& range_m,
                             const std::vector<float>& intensity) {
  BeamLog log;
  log.info.max_range_m = 100;
  log.resize(range_m.size());
  log.range_m = range_m;
  log.intensity = intensity;
  return log;
}

Score score_with_intensity(const BeamLog& real, const BeamLog& simulated,
                           const ScoreOptions& options = {}) {
  MemorySource a(real), b(simulated);
  return score(a, b, options);
}

TEST(Intensity, IsThatByHand) {
  BeamLog real = log_with_intensities({5, 5, 15, 15, kMiss, 15}, {1, 3, 5, 7, 9, 9});
  const BeamLog simulated = log_with_intensities({5, 5, 15, 15, 15, kMiss}, {2, 2, 5, 9, 9, 9});
  real.extra["class"] = std::vector<uint8_t>{0, 0, 0, 1, 1, 1};
  const Score all = score_with_intensity(real, simulated);
  ASSERT_TRUE(all.intensity);
  const IntensityScore& s = *all.intensity;
  // The first four beams return in both logs, with the errors 1, −1, 0 and 2.
  EXPECT_EQ(s.simulated.beams, 4u);
  EXPECT_DOUBLE_EQ(s.simulated.rmse, std::sqrt(6 / 4.0));
  EXPECT_DOUBLE_EQ(s.simulated.mae, 1);
  EXPECT_DOUBLE_EQ(s.real_mean, 4);
  EXPECT_DOUBLE_EQ(s.simulated_mean, 4.5);
  EXPECT_DOUBLE_EQ(s.real_sd, std::sqrt(5));
  // Covariance (1·2 + 3·2 + 5·5 + 7·9)/4 − 4·4.5 = 6, variances 5 and 33/4.
  EXPECT_NEAR(s.simulated.correlation, 6 / std::sqrt(5 * 8.25), 1e-12);
  EXPECT_DOUBLE_EQ(s.constant.rmse, std::sqrt(5));
  EXPECT_DOUBLE_EQ(s.constant.mae, 2);
  EXPECT_TRUE(std::isnan(s.constant.correlation));
  // The classes have the means 3 and 7.
  EXPECT_EQ(s.groups, "class");
  EXPECT_DOUBLE_EQ(s.group_constant.rmse, std::sqrt(8 / 4.0));
  // Sorted: 1 3 5 7 and 2 2 5 9.
  EXPECT_DOUBLE_EQ(s.wasserstein, 1);
  EXPECT_DOUBLE_EQ(s.per_range.at("0-10").rmse, 1);
  EXPECT_DOUBLE_EQ(s.per_range.at("10-20").rmse, std::sqrt(2));
  EXPECT_EQ(s.per_range.size(), 2u);
}

TEST(Intensity, LeavesOutMovers) {
  BeamLog real = log_with_intensities({5, 5}, {1, 3});
  real.flags[1] = kMover;
  EXPECT_EQ(
      score_with_intensity(real, log_with_intensities({5, 5}, {1, 9})).intensity->simulated.rmse,
      0);
}

TEST(Intensity, OfAModelIsToldApartByKindAndIncidence) {
  elements::Model model;
  model.surface.vertices = {{10, -50, -50}, {10, 50, -50}, {10, 0, 80}};
  model.surface.triangles = {{0, 1, 2}};
  model.surface.hit.resize(1);
  model.surface.range_sigma_m = 0.1;
  const trace::World world(model);
  BeamLog real = log_with_intensities({10, 3, 20}, {4, 6, 10});
  real.direction[2] = Vec3f(0.5f, std::sqrt(0.75f), 0);  // 60° to the wall, 20 m away
  BeamLog simulated = real;
  simulated.intensity = {5, 6, 7};
  ScoreOptions options;
  options.model = &world;
  const IntensityScore s = *score_with_intensity(real, simulated, options).intensity;
  EXPECT_EQ(s.groups, "kind");
  EXPECT_DOUBLE_EQ(s.group_constant.rmse, std::sqrt(18 / 3.0));  // 4 and 10 have the mean 7.
  EXPECT_DOUBLE_EQ(s.per_incidence.at("0-30").rmse, 1);
  EXPECT_EQ(s.per_incidence.size(), 2u);
}

TEST(Intensity, IsNotScoredWhereALogHasNone) {
  const BeamLog dark = log_with_intensities({5, 5}, {0, 0}),
                bright = log_with_intensities({5, 5}, {1, 2});
  EXPECT_EQ(score_with_intensity(dark, bright).no_intensity, "the real log has no intensities");
  EXPECT_EQ(score_with_intensity(bright, dark).no_intensity,
            "the simulated log has no intensities");
  EXPECT_FALSE(score_with_intensity(bright, dark).intensity);
  EXPECT_EQ(score_with_intensity(bright, log_with_intensities({kMiss, kMiss}, {0, 0})).no_intensity,
            "no beam returns in both logs");
}

}  // namespace
}  // namespace underbrush::metrics
