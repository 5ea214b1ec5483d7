// The correlation time of matter is found again from scans that repeat, and only from those.
#include "underbrush/calibrate/sway.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/simulate/simulate.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kInterval = 0.1;  // s, from scan to scan

/// Makes a hedge of ellipsoids 10 m away, 2 m high.
elements::Model hedge() {
  elements::Model model;
  model.tau = 3;
  model.grain.ellipsoid_m = 0.03;
  model.range_noise_m = 0.01;
  for (double y = -5; y <= 5; y += 0.3) {
    for (double z = -1; z <= 1; z += 0.3) {
      elements::Ellipsoid e;
      e.mean = Vec3(10.03, y, z).cast<float>();
      e.set_covariance(0.0225 * Mat3::Identity());
      e.hit.p = 0.6f;
      model.ellipsoids.push_back(e);
    }
  }
  return model;
}

/// Makes scans of 20 rings of 200 beams towards it. The sensor goes `step_m` from scan to scan.
BeamLog scans_of_it(uint32_t scans, double step_m = 0) {
  BeamLog log;
  log.info.max_range_m = 60;
  constexpr size_t kRows = 20, kColumns = 200;
  for (uint32_t s = 0; s < scans; ++s) {
    const Vec3 origin(0, step_m * s, 0);
    log.info.scans.push_back({s, kInterval * s, {}});
    log.info.scans.back().world_from_sensor.translation = origin;
    const size_t first = log.size();
    log.resize(first + kRows * kColumns);
    for (size_t i = 0; i < kRows * kColumns; ++i) {
      const double y = 0.04 * (double(i / kRows) - kColumns / 2.0);
      const double z = -0.95 + 0.1 * double(i % kRows);
      log.origin[first + i] = origin;
      log.direction[first + i] = Vec3(10, y, z).normalized().cast<float>();
      log.ring[first + i] = uint16_t(i % kRows);
      log.scan[first + i] = s;
      log.time_s[first + i] = kInterval * s;
    }
  }
  return log;
}

/// What a log of the hedge teaches; it sways with a correlation time, or stands still (0).
std::pair<SwayReport, double> learnt_of(BeamLog log, double sway_s) {
  elements::Model model = hedge();
  const auto draws = sway_s > 0 ? trace::Draws::kSwaying : trace::Draws::kOnce;
  simulate::Options options;
  options.seed = 42;
  options.sway_s = sway_s;
  simulate::simulate(trace::World(model, trace::Isa::kBest, draws), options, 0, log);
  MemorySource source(log);
  model.sway_s = 77;  // what it was before does not matter
  const SwayReport report = learn_sway(model, source, 1);
  return {report, model.sway_s};
}

TEST(LearnSway, FindsTheCorrelationTimeThatTheLogHas) {
  for (const double sway_s : {0.12, 0.2, 0.4}) {
    const auto [report, found] = learnt_of(scans_of_it(12), sway_s);
    EXPECT_TRUE(report.known);
    EXPECT_NEAR(report.interval_s, kInterval, 1e-9);
    EXPECT_NEAR(std::log(found / sway_s), 0, std::log(1.15)) << sway_s;
  }
}

TEST(LearnSway, IsNoShorterThanFromScanToScan) {
  const auto [report, found] = learnt_of(scans_of_it(12), 0.03);
  EXPECT_NEAR(std::log(found / kInterval), 0, std::log(1.1));
  EXPECT_NEAR(std::log(report.real_m / report.anew_m), 0, std::log(1.1));
}

TEST(LearnSway, StillMatterStaysStill) {
  const auto [report, found] = learnt_of(scans_of_it(12), 0);
  EXPECT_GT(report.pairs, 10000u);
  EXPECT_TRUE(report.known);
  EXPECT_EQ(found, 0);
  EXPECT_NEAR(std::log(report.real_m / report.still_m), 0, std::log(1.1));
  EXPECT_GT(report.anew_m, 2 * report.still_m);
}

TEST(LearnSway, ASensorThatMovesShowsNothing) {
  const auto [report, found] = learnt_of(scans_of_it(12, 0.06), 0.1);
  EXPECT_FALSE(report.stands);
  EXPECT_EQ(found, 0);
}

TEST(LearnSway, FewRepeatsOrNoTimesShowNothing) {
  BeamLog few = scans_of_it(2);
  BeamLog some = few.like();
  for (size_t i = 0; i < few.size(); i += 10) some.append(few, i);
  EXPECT_EQ(learnt_of(some, 0.1).second, 0);
  BeamLog timeless = scans_of_it(12);
  std::fill(timeless.time_s.begin(), timeless.time_s.end(), 0.0);
  EXPECT_EQ(learnt_of(timeless, 0).second, 0);
}

TEST(LearnSway, FindsItInALogThatDoesNotListItsScans) {
  BeamLog log = scans_of_it(12);
  log.info.scans.clear();
  const auto [report, found] = learnt_of(log, 0.2);
  EXPECT_TRUE(report.known);
  EXPECT_NEAR(std::log(found / 0.2), 0, std::log(1.15));
}

TEST(LearnSway, ManyBeamsOfOneDirectionAreQuick) {
  BeamLog log = scans_of_it(2);
  std::fill(log.direction.begin(), log.direction.end(), Vec3f(1, 0, 0));
  BeamLog many = log.like();
  for (int k = 0; k < 12; ++k) {
    for (size_t i = 0; i < log.size(); ++i) many.append(log, i);
  }
  std::stable_sort(many.scan.begin(), many.scan.end());
  for (size_t i = 0; i < many.size(); ++i) many.time_s[i] = kInterval * many.scan[i];
  EXPECT_TRUE(learnt_of(many, 0.1).first.stands);
}

TEST(LearnSway, FindsItInALogThatStandsOnlyForAWhileAndHasManyBeams) {
  BeamLog log = scans_of_it(40, 0.5);
  for (uint32_t s = 20; s < 40; ++s) {
    log.info.scans[s].world_from_sensor.translation = Vec3(0, 10, 0);
    for (size_t i = 0; i < 4000; ++i) log.origin[s * 4000 + i] = Vec3(0, 4, 0);
  }
  const auto [report, found] = learnt_of(log, 0.2);
  EXPECT_TRUE(report.known);
  EXPECT_NEAR(std::log(found / 0.2), 0, std::log(1.2));
}

}  // namespace
}  // namespace underbrush::calibrate
