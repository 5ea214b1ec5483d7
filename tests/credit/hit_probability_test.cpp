#include "underbrush/credit/hit_probability.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
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

std::vector<trace::Intersection> met_along_x(const elements::Model& model) {
  const trace::World world(model);
  std::vector<trace::Intersection> met;
  world.all_intersections({}, {0, 100}, 100, met);
  return met;
}

std::string said(const elements::Model& model, double range_m, const CreditOptions& options = {}) {
  std::vector<Credit> out;
  credit(model, met_along_x(model), range_m, options, out);
  std::string text;
  for (Credit c : out) text += c == Credit::kHit ? 'h' : c == Credit::kMiss ? 'm' : '-';
  return text;
}

TEST(Credit, GoesToTheFirstElementThatExplainsThePoint) {
  const elements::Model model = row_of_ellipsoids({5, 10, 10.1, 20});
  ASSERT_EQ(met_along_x(model).size(), 4u);
  // the element at 10 explains it (1 σ) and comes before that at 10.1
  EXPECT_EQ(said(model, 10.2), "mh--");
}

TEST(Credit, GoesToTheElementThatExplainsThePointBest) {
  const elements::Model model = row_of_ellipsoids({5, 10, 10.1, 20});
  CreditOptions best;
  best.rule = "best";
  EXPECT_EQ(said(model, 10.2, best), "mmh-");
  EXPECT_EQ(said(model, 10.02, best), "mh--");
  EXPECT_EQ(said(model, 9.7, best), "mh--");
  EXPECT_EQ(said(model, 15, best), "mmm-");
  EXPECT_EQ(said(model, kMiss, best), "mmmm");
}

TEST(Credit, OfTheBestGivesTheProbabilitiesThatMadeTheRanges) {
  // Two elements overlap along the beam, and the ray model draws the log. `first` gives the nearer
  // one most of the farther one's points, `best` gives it few.
  elements::Model truth = row_of_ellipsoids({10, 10.5});
  truth.ellipsoids[0].hit.p = 0.3f;
  truth.ellipsoids[1].hit.p = 0.5f;
  BeamLog log;
  log.info.has_misses = true;
  log.resize(20000);
  for (size_t i = 0; i < log.size(); ++i) {
    Stream random(mix64(31) + i);
    if (random.uniform() < 0.3) {
      log.range_m[i] = float(10 + 0.2 * random.normal());
    } else if (random.uniform() < 0.5) {
      log.range_m[i] = float(10.5 + 0.2 * random.normal());
    }
  }
  const auto p_of = [&](const char* rule) {
    elements::Model model = truth;
    MemorySource source(log);
    CreditOptions options;
    options.rule = rule;
    options.ellipsoid = {0, 0};
    count_hits(model, source, options);
    return std::array{model.ellipsoids[0].hit.p, model.ellipsoids[1].hit.p};
  };
  EXPECT_NEAR(p_of("best")[0], 0.3, 0.03);
  EXPECT_NEAR(p_of("best")[1], 0.5, 0.04);
  EXPECT_GT(p_of("first")[0], 0.4);
}

TEST(Credit, OfAnUnexplainedPointIsAMissForAllBeforeIt) {
  const elements::Model model = row_of_ellipsoids({5, 10, 20});
  EXPECT_EQ(said(model, 15), "mm-");
}

TEST(Credit, OfAMissBeamIsAMissForAll) {
  const elements::Model model = row_of_ellipsoids({5, 10, 20});
  EXPECT_EQ(said(model, kMiss), "mmm");
}

TEST(Credit, OfATriangleTakesTheResidualInBothDirections) {
  elements::Model model;
  model.ground.vertices = {{10, -1, -1}, {10, 3, -1}, {10, -1, 3}};
  model.ground.triangles = {{0, 1, 2}};
  model.ground.hit.resize(1);
  for (const char* rule : {"first", "best", "mahalanobis"}) {
    CreditOptions options;
    options.rule = rule;
    for (double z : {9.3, 10.7}) EXPECT_EQ(said(model, z, options), "h") << z;
    EXPECT_EQ(said(model, 9.2, options), "-");   // the beam ended before it
    EXPECT_EQ(said(model, 10.8, options), "m");  // the beam went through it
  }
}

// In the example of [deschaud12] Fig. 2, four beams enter, three end inside and one goes on, so
// that ρ = 1/4.
TEST(Credit, MahalanobisTakesEachElementByItself) {
  const elements::Model model = row_of_ellipsoids({5, 10, 10.1, 20});
  CreditOptions options;
  options.rule = "mahalanobis";
  EXPECT_EQ(said(model, 10.2, options), "mhh-");  // both elements that hold the point
  // behind one by 2.25 σ, within 1.75 σ of the other
  EXPECT_EQ(said(model, 10.45, options), "mmh-");
  EXPECT_EQ(said(model, kMiss, options), "mmmm");
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

TEST(CountHits, GivesThePermeabilityOfThePapersExample) {
  elements::Model model = row_of_ellipsoids({5});
  const BeamLog log = beams_along_x({4.9f, 5, 5.2f, kMiss});
  MemorySource source(log);
  CreditOptions options;
  options.rule = "mahalanobis";
  options.ellipsoid = {0, 0};
  count_hits(model, source, options);
  EXPECT_FLOAT_EQ(1 - model.ellipsoids[0].hit.p, 0.25f);
}

TEST(CountHits, RefusesWhatHasNoName) {
  elements::Model model = row_of_ellipsoids({5});
  const BeamLog log = beams_along_x({5});
  MemorySource source(log);
  CreditOptions rule;
  rule.rule = "last";
  EXPECT_THROW(count_hits(model, source, rule), std::invalid_argument);
}

// Beams that are drawn from a known permeability must give it back.
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
}  // namespace underbrush::credit
