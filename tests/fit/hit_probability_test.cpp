#include "underbrush/fit/hit_probability.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::fit {
namespace {

elements::Model row_of_ellipsoids(const std::vector<double>& at) {
  elements::Model model;
  model.tau = 2;
  for (double x : at) {
    elements::Ellipsoid e;
    e.mean = Vec3f(float(x), 0, 0);
    e.set_covariance(0.04 * Mat3::Identity());
    model.ellipsoids.push_back(e);
  }
  return model;
}

std::vector<trace::Met> met_along_x(const elements::Model& model) {
  const trace::World world(model);
  std::vector<trace::Met> met;
  world.all_met({}, {0, 100}, 100, met);
  return met;
}

TEST(Credit, GoesToTheFirstElementThatExplainsThePoint) {
  const elements::Model model = row_of_ellipsoids({5, 10, 10.1, 20});
  const auto met = met_along_x(model);
  ASSERT_EQ(met.size(), 4u);
  const Credit c = credit(model, met, 10.2, {});
  EXPECT_EQ(c.hit, 1u);     // 10 explains it (1 σ), before 10.1 does
  EXPECT_EQ(c.misses, 1u);  // only the one at 5
}

TEST(Credit, OfAnUnexplainedPointIsAMissForAllBeforeIt) {
  const elements::Model model = row_of_ellipsoids({5, 10, 20});
  const Credit c = credit(model, met_along_x(model), 15, {});
  EXPECT_EQ(c.hit, 3u);
  EXPECT_EQ(c.misses, 2u);
}

TEST(Credit, OfAMissBeamIsAMissForAll) {
  const elements::Model model = row_of_ellipsoids({5, 10, 20});
  const Credit c = credit(model, met_along_x(model), kMiss, {});
  EXPECT_EQ(c.hit, 3u);
  EXPECT_EQ(c.misses, 3u);
}

TEST(Credit, OfATriangleTakesTheResidualInBothDirections) {
  elements::Model model;
  model.ground.vertices = {{10, -1, -1}, {10, 3, -1}, {10, -1, 3}};
  model.ground.triangles = {{0, 1, 2}};
  model.ground.hit.resize(1);
  const auto met = met_along_x(model);
  ASSERT_EQ(met.size(), 1u);
  for (double z : {9.3, 10.7}) EXPECT_EQ(credit(model, met, z, {}).hit, 0u) << z;
  EXPECT_EQ(credit(model, met, 9.2, {}).misses, 0u);   // ended before it
  EXPECT_EQ(credit(model, met, 10.8, {}).misses, 1u);  // went through it
}

BeamLog beams_along_x(const std::vector<float>& ranges) {
  BeamLog log;
  log.info.max_range_m = 100;
  log.info.has_misses = true;
  log.resize(ranges.size());
  log.range_m = ranges;
  return log;
}

TEST(CountHits, IsTheRatioWithPriors) {
  elements::Model model = row_of_ellipsoids({5, 10, 50});
  model.ellipsoids[2].mean.y() = 30;  // off the beams
  const BeamLog log = beams_along_x({5, 5, 10, 10, 10, 10, kMiss});
  MemorySource source(log);
  CreditOptions options;
  options.ellipsoid = {0, 1};
  count_hits(model, source, options);
  EXPECT_EQ(model.ellipsoids[0].hit.hits, 2u);
  EXPECT_EQ(model.ellipsoids[0].hit.misses, 5u);
  EXPECT_FLOAT_EQ(model.ellipsoids[0].hit.p, 2.0f / 8);
  EXPECT_EQ(model.ellipsoids[1].hit.hits, 4u);
  EXPECT_EQ(model.ellipsoids[1].hit.misses, 1u);
  EXPECT_FLOAT_EQ(model.ellipsoids[1].hit.p, 4.0f / 6);
  EXPECT_EQ(model.ellipsoids[2].hit.misses, 0u);
}

// Beams drawn from a known permeability must give it back.
TEST(CountHits, RecoversThePermeabilityThatMadeTheBeams) {
  elements::Model model = row_of_ellipsoids({5, 10});
  Stream random(12);
  std::vector<float> ranges;
  for (int i = 0; i < 20000; ++i) {
    const bool first = random.uniform() < 0.3, second = random.uniform() < 0.7;
    ranges.push_back(first ? 5.0f : second ? 10.0f : kMiss);
  }
  const BeamLog log = beams_along_x(ranges);
  MemorySource source(log, 777);
  for (int threads : {1, 2}) {
    set_threads(threads);
    count_hits(model, source, {});
    EXPECT_NEAR(model.ellipsoids[0].hit.p, 0.3, 0.01);
    EXPECT_NEAR(model.ellipsoids[1].hit.p, 0.7, 0.01);
    EXPECT_EQ(model.ellipsoids[0].hit.hits + model.ellipsoids[0].hit.misses, 20000u);
  }
  set_threads(0);
}

}  // namespace
}  // namespace underbrush::fit
