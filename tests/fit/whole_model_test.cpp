// Tests of what a fit learns beside the geometry: the grain, from first echoes or all.
#include <gtest/gtest.h>

#include "fit/two_bushes.hpp"
#include "underbrush/calibrate/grain.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::fit {
namespace {

void expect_same_grain(const elements::Model& a, const elements::Model& b) {
  EXPECT_EQ(a.grain.ellipsoid_m, b.grain.ellipsoid_m);
  EXPECT_EQ(a.grain.mesh_m, b.grain.mesh_m);
  EXPECT_EQ(a.range_noise_m, b.range_noise_m);
}

TEST(Fit, LearnsTheGrainWithTheFinishedModel) {
  const BeamLog log = test::drive_past_two_bushes(11, Vec3::Zero(), 20000);
  MemorySource source(log);
  FitOptions options;
  const FitResult with = fit(source, options);
  options.learn_grain = false;
  FitResult without = fit(source, options);
  EXPECT_FALSE(without.report.grain.learnt());
  EXPECT_EQ(without.model.range_noise_m, options.range_noise_m);
  const calibrate::GrainReport report = calibrate::learn_grain(without.model, source, options.seed);
  EXPECT_TRUE(report.learnt());
  EXPECT_NE(with.model.grain.mesh_m, elements::Grain().mesh_m);
  expect_same_grain(with.model, without.model);
  EXPECT_EQ(with.report.grain.simulated_m, report.simulated_m);
}

/// Makes a log whose every third beam that returns has a second echo 1 m behind the first.
BeamLog with_second_echoes(const BeamLog& log) {
  BeamLog rows = log.like();
  std::vector<uint8_t> echo;
  for (size_t i = 0; i < log.size(); ++i) {
    rows.append(log, i);
    echo.push_back(log.is_hit(i));
    if (!log.is_hit(i) || i % 3) continue;
    rows.append(log, i);
    rows.range_m.back() += 1;
    echo.push_back(2);
  }
  rows.extra[kEchoColumn] = echo;
  return rows;
}

TEST(Fit, TakesTheFirstEchoOfEachRowOrAll) {
  const BeamLog log = test::drive_past_two_bushes(12, Vec3::Zero(), 15000),
                echoes = with_second_echoes(log);
  ASSERT_GT(echoes.size(), log.size());
  MemorySource beams(log), rows(echoes, 1000);
  const FitResult a = fit(beams, {}), b = fit(rows, {});
  EXPECT_EQ(b.report.beams, log.size());
  EXPECT_EQ(a.model.ground.vertices, b.model.ground.vertices);
  ASSERT_EQ(a.model.ellipsoids.size(), b.model.ellipsoids.size());
  for (size_t i = 0; i < a.model.ellipsoids.size(); ++i) {
    EXPECT_EQ(a.model.ellipsoids[i].mean, b.model.ellipsoids[i].mean);
  }
  expect_same_grain(a.model, b.model);
  EXPECT_FALSE(b.model.all_echoes);
  FitOptions options;
  options.all_echoes = true;
  const FitResult all = fit(rows, options);
  EXPECT_EQ(all.report.beams, echoes.size());
  EXPECT_TRUE(all.model.all_echoes);
  EXPECT_FALSE(all.model.keyframes);
}

}  // namespace
}  // namespace underbrush::fit
