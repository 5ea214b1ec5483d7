#include "underbrush/calibrate/light.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drive_past.hpp"
#include "underbrush/calibrate/light_response.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/element_light.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::calibrate {
namespace {

using elements::Light;
using elements::Reflectance;

/// Makes ground of many triangles with bushes above it, each with a reflectance of its own, and a
/// response that falls with the range and under grazing incidence.
elements::Model lit_world() {
  elements::Model truth = test::flat_ground(30);
  truth.ground.vertices.clear();
  truth.ground.triangles.clear();
  constexpr uint32_t kSide = 13;
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      truth.ground.vertices.emplace_back(5.0f * float(x) - 30, 5.0f * float(y) - 30, 0.0f);
      if (x == 0 || y == 0) continue;
      const uint32_t a = (y - 1) * kSide + x - 1, b = y * kSide + x - 1;
      truth.ground.triangles.push_back({a, a + 1, b + 1});
      truth.ground.triangles.push_back({a, b + 1, b});
    }
  }
  truth.ground.hit.resize(truth.ground.triangles.size());
  Stream random(11);
  for (size_t i = 0; i < truth.ground.size(); ++i) {
    truth.ground.light.push_back({float(random.uniform(20, 60)), 4});
  }
  for (int k = 0; k < 24; ++k) {
    const double angle = 0.26 * k, far = 9 + k % 3 * 5;
    test::add_bush(Vec3f(float(far * std::cos(angle)), float(far * std::sin(angle)), 1.6f),
                   Vec3(0.05, 0.05, 0.05), 0.8f, truth);
    truth.ellipsoids.back().light = {float(random.uniform(60, 200)), 15};
  }
  truth.light.max_intensity = 1000;
  truth.light.range = {{2, 8, 32}, {1.4, 1.0, 0.6}};
  truth.light.incidence[0] = {{0, 0.2, 1}, {0.5, 1.0, 1.3}};
  truth.light.ring = {0.8, 1.2};
  return truth;
}

BeamLog lit_log(const elements::Model& truth, size_t beams = 120000) {
  BeamLog log = test::drive_past(truth, 3, beams, 4000, -0.5);
  for (size_t i = 0; i < log.size(); ++i) log.ring[i] = uint16_t(i % 2);
  simulate::Options options;
  options.seed = 5;
  options.intensity = simulate::IntensityDraw::kDrawn;
  simulate::simulate(trace::World(truth), options, 0, log);
  return log;
}

elements::Model without_light(elements::Model model) {
  model.light = {};
  model.ground.light.clear();
  for (elements::Ellipsoid& e : model.ellipsoids) e.light = {};
  return model;
}

elements::Model learnt(const elements::Model& truth, const BeamLog& log, size_t chunk = 1 << 20) {
  elements::Model model = without_light(truth);
  MemorySource source(log, chunk);
  learn_light(model, source);
  return model;
}

// The reflectance has no scale of its own (each factor is 1 on average), so that what is compared
// is the intensity of a beam, of which the log has 4 % and 8 % noise.
// A log whose brightest return is not among the samples.
TEST(Light, OfReturnsWithoutIntensityNothingIsLearnt) {
  const elements::Model truth = lit_world();
  BeamLog log = lit_log(truth);
  for (size_t i = 0; i < log.size(); ++i) log.intensity[i] = 0;
  for (const float brightest : {0.0f, 1e-44f}) {
    size_t up = 0;  // the first return of a beam that no element explains
    while (!log.is_hit(up)) ++up;
    log.intensity[up] = brightest;
    log.range_m[up] = 0.6f;
    elements::Model model = truth;
    MemorySource source(log);
    learn_light(model, source);
    EXPECT_FALSE(model.light.known());
    EXPECT_TRUE(model.ground.light.empty());
  }
}

/// A reflectance is a mean of intensities over the response, which is less than 1 for many returns.
TEST(Light, OfIntensitiesAtTheLimitOfAFloatIsFiniteOrNone) {
  const elements::Model truth = lit_world();
  size_t without = 0;
  for (const size_t every : {1, 2, 7, 50}) {
    BeamLog log = lit_log(truth);
    for (size_t i = 0; i < log.size(); i += every) log.intensity[i] = 3.4e38f;
    elements::Model model = truth;
    MemorySource source(log);
    learn_light(model, source);
    EXPECT_NO_THROW(model.check()) << every;
    without += !model.light.known();
  }
  EXPECT_GT(without, 0u);
}

TEST(Light, PredictsTheIntensitiesOfAKnownModelWithinThreePercent) {
  const elements::Model truth = lit_world();
  const BeamLog log = lit_log(truth);
  const elements::Model model = learnt(truth, log);
  ASSERT_TRUE(model.light.known());
  BeamLog expected = log, predicted = log;
  simulate::simulate(trace::World(truth), {}, 0, expected);
  simulate::simulate(trace::World(model), {}, 0, predicted);
  ASSERT_EQ(expected.range_m, predicted.range_m);
  double squared = 0, n = 0, spread = 0, mean = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    if (!expected.is_hit(i)) continue;
    squared += std::pow(predicted.intensity[i] / expected.intensity[i] - 1, 2);
    mean += expected.intensity[i];
    spread += std::pow(expected.intensity[i], 2);
    n += 1;
  }
  EXPECT_LT(std::sqrt(squared / n), 0.03);
  // A constant is far worse, so that the tolerance says something.
  EXPECT_GT(std::sqrt(spread / n - std::pow(mean / n, 2)) / (mean / n), 0.3);
}

TEST(Light, RecoversReflectanceSpreadAndResponseUpToScale) {
  const elements::Model truth = lit_world();
  const elements::Model model = learnt(truth, lit_log(truth));
  const double scale = model.ellipsoids[0].light.mean / truth.ellipsoids[0].light.mean;
  for (size_t k = 0; k < truth.ellipsoids.size(); ++k) {
    EXPECT_NEAR(model.ellipsoids[k].light.mean / truth.ellipsoids[k].light.mean / scale, 1, 0.05);
    EXPECT_NEAR(model.ellipsoids[k].light.spread / truth.ellipsoids[k].light.spread / scale, 1,
                0.25);
  }
  const auto& f = model.light.range;
  EXPECT_NEAR(f(20) / f(6), truth.light.range(20) / truth.light.range(6), 0.04);
  EXPECT_NEAR(model.light.ring[1] / model.light.ring[0], 1.5, 0.02);
  const auto& g = model.light.incidence[0];
  EXPECT_NEAR(g(0.08) / g(0.3), truth.light.incidence[0](0.08) / truth.light.incidence[0](0.3),
              0.06);
}

TEST(Light, IsTheSameForAnyNumberOfThreadsAndAnyChunks) {
  const elements::Model truth = lit_world();
  const BeamLog log = lit_log(truth, 30000);
  const elements::Model all = learnt(truth, log);
  set_threads(1);
  const elements::Model one = learnt(truth, log, 7777);
  set_threads(0);
  EXPECT_EQ(all.light.range.gain, one.light.range.gain);
  EXPECT_EQ(all.light.ring, one.light.ring);
  for (size_t e = 0; e < truth.size(); ++e) {
    EXPECT_EQ(elements::reflectance(all, e).mean, elements::reflectance(one, e).mean);
    EXPECT_EQ(elements::reflectance(all, e).spread, elements::reflectance(one, e).spread);
  }
}

TEST(Light, ChangesNothingButTheLight) {
  const elements::Model truth = lit_world();
  BeamLog log = lit_log(truth);
  MemorySource bright(log);
  fit::FitResult with = fit::fit(bright, {});
  log.intensity.assign(log.size(), 0);
  MemorySource dark(log);
  const fit::FitResult without = fit::fit(dark, {});
  EXPECT_TRUE(with.model.light.known());
  EXPECT_FALSE(without.model.light.known());
  EXPECT_TRUE(without.model.ground.light.empty());
  ASSERT_EQ(with.model.size(), without.model.size());
  EXPECT_EQ(with.model.ground.vertices, without.model.ground.vertices);
  for (size_t i = 0; i < without.model.ellipsoids.size(); ++i) {
    const elements::Ellipsoid &a = with.model.ellipsoids[i], &b = without.model.ellipsoids[i];
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.hit.p, b.hit.p);
    EXPECT_EQ(b.light.mean, 0);
  }
}

/// Elements 0 to 39 of one group have the mean of 30 (even) or 50 (odd) of 20 returns; element 40
/// has one return, and 41 none.
std::vector<LightSums> two_levels(double noise) {
  std::vector<LightSums> sums(42);
  for (size_t e = 0; e < 40; ++e) {
    for (int k = 0; k < 20; ++k) sums[e].add((e % 2 ? 50 : 30) + (k % 2 ? noise : -noise), 1);
  }
  sums[40].add(50, 1);
  return sums;
}

TEST(Reflectances, OfThinDataFallBackToTheMeanOfTheGroup) {
  const std::vector<uint32_t> group(42, 0);
  const std::vector<Reflectance> some = reflectances(two_levels(20), group, 1);
  const double mean = (20 * 20 * 30 + 20 * 20 * 50 + 50) / 801.0;
  EXPECT_NEAR(some[41].mean, mean, 1e-4);
  // By hand: s² = 800 · 400 / 760, and τ² is about the variance of the means less s²/20.
  const double within = 800 * 400 / 760.0, between = 100 * 40 / 39.0 - within / 20;
  const double lambda = within / between;
  EXPECT_NEAR(some[40].mean, (50 + lambda * mean) / (1 + lambda), 0.1);
  EXPECT_NEAR(some[1].mean, (1000 + lambda * mean) / (20 + lambda), 0.05);
  EXPECT_NEAR(some[1].spread, 20, 0.2);
  // Without noise within elements there is nothing to doubt.
  EXPECT_EQ(reflectances(two_levels(0), group, 1)[40].mean, 50);
}

TEST(Reflectances, OfAGroupWithoutReturnsAreThoseOfAllElements) {
  std::vector<uint32_t> group(42, 0);
  group[41] = 1;
  const std::vector<Reflectance> some = reflectances(two_levels(20), group, 2);
  EXPECT_NEAR(some[41].mean, 40.0, 0.1);
  EXPECT_GT(some[41].spread, 0);
}

}  // namespace
}  // namespace underbrush::calibrate
