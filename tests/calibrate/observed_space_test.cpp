#include "underbrush/calibrate/observed_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/trace/unknown_space.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kDensity = 0.05;  // 1/m
constexpr double kTopM = 4, kReachM = 60;

/// A model of flat ground.
elements::Model flat_model() {
  elements::Model m;
  for (int x = -20; x <= 120; x += 2) {
    for (int y = -70; y <= 70; y += 2) m.ground.vertices.emplace_back(float(x), float(y), 0.0f);
  }
  return m;
}

/// Beams of a sensor that drives along x, through a medium of one density up to `kTopM` over flat
/// ground. Each beam meets its own medium.
BeamLog log_of_drive(size_t beams) {
  BeamLog log;
  log.info.max_range_m = kReachM;
  log.info.has_misses = true;
  log.resize(beams);
  Stream random(7);
  for (size_t i = 0; i < beams; ++i) {
    const double along = double(i) / double(beams);
    log.scan[i] = uint32_t(100 * along);
    log.origin[i] = Vec3(100 * along, 0, 1.5);
    const double azimuth = random.uniform(0, 2 * M_PI), rise = random.uniform(-0.1, 0.1);
    log.direction[i] = Vec3(std::cos(azimuth), std::sin(azimuth), rise).normalized().cast<float>();
    const Vec3 d = log.direction[i].cast<double>();
    const double ground = d.z() < 0 ? -1.5 / d.z() : HUGE_VAL;
    const double top = d.z() > 0 ? (kTopM - 1.5) / d.z() : HUGE_VAL;
    const double free = -std::log1p(-random.uniform()) / kDensity;
    const double end = free < top ? std::min(free, ground) : HUGE_VAL;
    log.range_m[i] = end < kReachM ? float(end) : kMiss;
  }
  return log;
}

TEST(ObservedSpace, KnowsTheCellsThatBeamsCrossedAndNoOthers) {
  elements::Model m = flat_model();
  BeamLog log;
  log.info.max_range_m = 60;
  log.info.has_misses = true;
  log.resize(3);
  for (size_t i = 0; i < 3; ++i) {
    log.scan[i] = uint32_t(i);
    log.origin[i] = Vec3(0.5, 0.5, 1.5);
    log.direction[i] = Vec3f::UnitX();
    log.range_m[i] = 10;
  }
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  m.observed->check();
  const trace::CrossedCells cells(*m.observed);
  EXPECT_EQ(cells.at({0, 0, 1}), 3);
  EXPECT_EQ(cells.at({10, 0, 1}), 3);
  EXPECT_EQ(cells.at({11, 0, 1}), 0);
  EXPECT_EQ(cells.at({5, 1, 1}), 0);
  update_observed_space(m, source, 0);
  EXPECT_EQ(trace::CrossedCells(*m.observed).at({10, 0, 1}), 6);
  learn_observed_space(m, source, {0, 0});
  EXPECT_FALSE(m.observed);
}

TEST(ObservedSpace, LearnsTheDensityOfAMediumThatNobodySaw) {
  elements::Model m = flat_model();
  const BeamLog log = log_of_drive(60000);
  MemorySource source(log);
  learn_observed_space(m, source, {1, 0});
  ASSERT_TRUE(m.observed);
  const auto& density = m.observed->density_per_m;
  const size_t r = elements::ObservedSpace::range_interval(30);
  for (const double h : {1.5, 3.0}) {
    EXPECT_NEAR(double(density[elements::ObservedSpace::height_interval(h)][r]), kDensity,
                0.25 * kDensity)
        << h;
  }
  EXPECT_EQ(density[elements::ObservedSpace::height_interval(20)][r], 0);
}

}  // namespace
}  // namespace underbrush::calibrate
