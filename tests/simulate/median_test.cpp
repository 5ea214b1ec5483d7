// Tests of answers without a draw: the median of a mixture, and of what a beam may measure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive_past.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::simulate {
namespace {

using trace::RangeMixture;

/// The share of the returns of a mixture that are nearer than a range.
double share_below(const RangeMixture& p, double range_m) {
  double sum = 0;
  for (const RangeMixture::Component& c : p.components) {
    const double off = range_m - c.t_m;
    sum += c.sigma_m > 0 ? 0.5 * c.weight * std::erfc(-off / (std::sqrt(2) * c.sigma_m))
                         : (off >= 0 ? c.weight : 0);
  }
  return sum / p.returns();
}

// Half of the returns are nearer than the median, whatever the mixture; seeds 1 to 3000.
TEST(Median, HalvesTheReturnsOfAnyMixture) {
  for (uint64_t seed = 1; seed <= 3000; ++seed) {
    Stream random(seed);
    RangeMixture p;
    const size_t n = 1 + random.below(30);
    double sum = 0;
    for (size_t k = 0; k < n; ++k) {
      const double sigma = random.below(6) == 0 ? 0 : std::exp(random.uniform(-6, 2));
      p.components.push_back({random.uniform(0.01, 1), random.uniform(1, 80), sigma});
      sum += p.components.back().weight;
    }
    p.miss = random.uniform(0, 0.9);
    for (RangeMixture::Component& c : p.components) c.weight *= (1 - p.miss) / sum;
    const std::optional<double> median = p.median();
    ASSERT_EQ(median.has_value(), p.returns() >= 0.5) << seed;
    if (!median) continue;
    EXPECT_LE(share_below(p, *median - 0.001), 0.5 + 1e-6) << seed;
    EXPECT_GE(share_below(p, *median + 0.001), 0.5 - 1e-6) << seed;
  }
}

// Half of one component lies at its middle, but for rounding, from which no step may lead away.
TEST(Median, OfOneComponentIsItsMiddle) {
  for (uint64_t seed = 1; seed <= 3000; ++seed) {
    Stream random(seed);
    RangeMixture p;
    const double weight = random.uniform(0.5, 1), t = random.uniform(1, 80);
    const double part = random.uniform(0.1, 0.9), sigma = std::exp(random.uniform(-700, 1));
    p.components = {{weight * part, t, sigma}, {weight - weight * part, t, 3 * sigma}};
    p.miss = 1 - weight;
    ASSERT_TRUE(p.median()) << seed;
    EXPECT_NEAR(*p.median(), t, 0.001) << seed;
  }
}

// Where a step of a metre is lost in rounding, the search ends all the same.
TEST(Median, OfRangesBeyondAllBoundsIsFound) {
  RangeMixture p;
  p.components = {{0.3, 1e25, 1e20}, {0.4, 2e25, 1e21}, {0.3, 1, 0}};
  p.miss = 0;
  ASSERT_TRUE(p.median());
  EXPECT_FALSE(std::isnan(*p.median()));
}

TEST(Median, OfNothingIsAMiss) {
  EXPECT_FALSE(RangeMixture().median());
  RangeMixture p;
  p.components = {{0.3, 5, 0.1}, {0.15, 9, 0.1}};
  p.miss = 0.55;
  EXPECT_FALSE(p.median());
  p.components.push_back({0.1, 20, 0});
  p.miss = 0.45;
  ASSERT_TRUE(p.median());
  EXPECT_NEAR(*p.median(), 5 + 0.1 * 1.383, 0.001);  // 0.275 of 0.3
  EXPECT_EQ(p.likeliest_at(5.1), 0u);
  EXPECT_EQ(p.likeliest_at(9.2), 1u);
  EXPECT_EQ(p.likeliest_at(19), 2u);  // none is likely there
}

elements::Model site() {
  elements::Model truth = test::flat_ground(60);
  test::add_bush({-4, -8, 1.2f}, {0.3, 0.3, 0.2}, 0.4f, truth);
  test::add_bush({-8, 10, 1.2f}, {0.3, 0.3, 0.2}, 0.9f, truth);
  test::add_bush({4, 9, 1.0f}, {0.4, 0.1, 0.2}, 0.7f, truth);
  return truth;
}

BeamLog answered(const elements::Model& model, BeamLog beams, RangeDraw draw, uint64_t seed = 1) {
  Options options;
  options.draw = draw;
  options.seed = seed;
  options.element_ids = true;
  simulate(trace::World(model), options, 0, beams);
  return beams;
}

/// The mean absolute error over the beams that return in both logs, m, and the share of beams of
/// which one returned and the other did not.
std::pair<double, double> errors(const BeamLog& real, const BeamLog& answer) {
  double sum = 0, both = 0, wrong = 0;
  for (size_t i = 0; i < real.size(); ++i) {
    if (real.is_hit(i) != answer.is_hit(i)) ++wrong;
    if (!real.is_hit(i) || !answer.is_hit(i)) continue;
    sum += std::abs(double(real.range_m[i]) - double(answer.range_m[i]));
    ++both;
  }
  return {sum / both, wrong / double(real.size())};
}

// What was drawn from a model is foretold by its median better than by another draw.
TEST(Median, HasTheLeastError) {
  const elements::Model model = site();
  const BeamLog real = test::drive_past(model, 1, 40'000, 4000, -0.4);
  const auto [range, share] = errors(real, answered(model, real, RangeDraw::kMedian));
  const auto [drawn_range, drawn_share] = errors(real, answered(model, real, RangeDraw::kOnRay, 2));
  EXPECT_LT(range, 0.8 * drawn_range);
  EXPECT_LT(share, 0.8 * drawn_share);
}

TEST(Median, KnowsNoSeedNoChunkAndNoThreads) {
  const elements::Model model = site();
  const BeamLog real = test::drive_past(model, 1, 30'000, 4000, -0.4);
  set_threads(1);
  const BeamLog one = answered(model, real, RangeDraw::kMedian, 1);
  set_threads(2);
  const BeamLog two = answered(model, real, RangeDraw::kMedian, 99);
  set_threads(0);
  EXPECT_EQ(one.range_m, two.range_m);
  BeamLog part = real.like();
  part.append(real, 12'345, 20'000);
  const BeamLog alone = answered(model, part, RangeDraw::kMedian, 5);
  EXPECT_TRUE(std::equal(alone.range_m.begin(), alone.range_m.end(), one.range_m.begin() + 12'345));
}

// The element that is named is one whose share of the returns is at the median.
TEST(Median, NamesTheElementAtItsRange) {
  const elements::Model model = site();
  const BeamLog real = test::drive_past(model, 1, 20'000, 4000, -0.4);
  const BeamLog answer = answered(model, real, RangeDraw::kMedian);
  const auto& element = std::get<std::vector<uint32_t>>(answer.extra.at("element"));
  size_t of_bushes = 0;
  for (size_t i = 0; i < answer.size(); ++i) {
    ASSERT_EQ(element[i] == trace::Intersection::kNone, !answer.is_hit(i));
    if (!answer.is_hit(i) || model.kind(element[i]) == elements::Kind::kGround) continue;
    const elements::Ellipsoid& bush = model.ellipsoids[model.place(element[i]).index];
    EXPECT_NE(model.place(element[i]).index, 0u);  // three of five beams pass it
    EXPECT_LT((answer.end_point(i) - bush.mean.cast<double>()).norm(), 2.5);
    ++of_bushes;
  }
  EXPECT_GT(of_bushes, 100u);
}

TEST(Median, IsThatOfStillMatterWhereItSways) {
  const elements::Model model = site();
  BeamLog still = test::drive_past(model, 1, 100, 100, -0.4), swaying = still;
  Options options;
  options.draw = RangeDraw::kMedian;
  simulate(trace::World(model), options, 0, still);
  options.sway_s = 1;
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kSwaying);
  simulate(world, options, 0, swaying);
  EXPECT_EQ(still.range_m, swaying.range_m);
}

TEST(Median, IsRefusedWhereRaysAreDrawn) {
  const elements::Model model = site();
  BeamLog beams = test::drive_past(model, 1, 100, 100, -0.4);
  Options options;
  options.draw = RangeDraw::kMedian;
  options.random_ray.emplace();
  EXPECT_THROW(simulate(trace::World(model), options, 0, beams), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::simulate
