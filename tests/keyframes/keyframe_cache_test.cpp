// Tests of the look-up in keyframes: from a place beside them, a beam sees points where they are
// from there.
#include "underbrush/keyframes/keyframe_cache.hpp"

#include <gtest/gtest.h>

#include "ball_scanner.hpp"

namespace underbrush::keyframes {
namespace {

using test::fitted;
using test::kDrive;
using test::scanned;
using test::uniform;

// What is seen from beside a keyframe lies where it is: most beams' nearest pixel has the true
// range, but for those at the rims of balls.
TEST(KeyframeCache, SeesPointsFromBesideTheKeyframe) {
  const BeamLog drive = scanned({0}, 0, 0.7);
  const elements::Model model = fitted(drive, 1);
  const KeyframeCache cache(model);
  for (const double aside : {0.0, 0.3, 1.0}) {
    const BeamLog test = scanned({aside}, 100);
    const std::vector<uint32_t> all{0};
    size_t seen = 0, right = 0;
    for (size_t i = 0; i < test.size(); ++i) {
      if (!test.is_hit(i) || test.range_m[i] > 15) continue;
      const Ray ray = test.ray(i);
      const KeyframeCache::Query query{ray, cache.near(ray.origin, all), 0};
      const CachedPixels r = cache.look_up({&query, 1})[0];
      if (r.count == 0 || r.rank[0] != 0) continue;
      ++seen;
      // Half a pixel of elevation moves the place where a beam meets the ground.
      const double slack = 0.05 + 0.01 * test.range_m[i] * test.range_m[i] / 2;
      right += std::abs(r.range_m[0] - double(test.range_m[i])) < slack;
    }
    EXPECT_GT(double(seen), 0.5 * double(test.size()) * 0.5);
    EXPECT_GT(double(right), (aside == 0 ? 0.93 : aside < 1 ? 0.85 : 0.75) * double(seen)) << aside;
  }
}

struct Looked {
  elements::Model model;
  std::vector<Ray> rays;
  std::vector<uint16_t> rings;
};

// A model with keyframes, and rays near them and far from them.
Looked looked() {
  Looked out{fitted(scanned(kDrive, 0, 0.7), 1), {}, {}};
  const BeamLog test = scanned({1.0, 3.3, 9.5, 25}, 100, 0.7);
  out.rings = test.ring;
  for (size_t i = 0; i < test.size(); ++i) out.rays.push_back(test.ray(i));
  return out;
}

TEST(KeyframeCache, TheLookUpOfABeamDoesNotDependOnTheOthers) {
  const Looked of = looked();
  const KeyframeCache cache(of.model);
  const std::vector<KeyframeCache::Query> queries = cache.queries(of.rays, of.rings);
  const std::vector<CachedPixels> all = cache.look_up(queries);
  size_t seen = 0;
  for (size_t i = 0; i < queries.size(); i += 7) {
    const CachedPixels alone = cache.look_up({&queries[i], 1})[0];
    ASSERT_EQ(alone.count, all[i].count);
    EXPECT_EQ(alone.situation, all[i].situation);
    for (size_t k = 0; k < alone.count; ++k) {
      EXPECT_EQ(alone.range_m[k], all[i].range_m[k]);
      EXPECT_EQ(alone.rank[k], all[i].rank[k]);
    }
    seen += alone.count > 0;
  }
  EXPECT_GT(seen, queries.size() / 7 / 3);
}

// A simulation draws before it looks. What it then draws is what it would have drawn after a look.
TEST(KeyframeCache, ADrawBeforeTheLookUpChangesNothing) {
  const Looked of = looked();
  const KeyframeCache cache(of.model);
  std::vector<KeyframeCache::Query> queries = cache.queries(of.rays, of.rings);
  const std::vector<CachedPixels> all = cache.look_up(queries);
  for (size_t i = 0; i < queries.size(); ++i) queries[i].u = uniform(i, 11);
  const std::vector<CachedPixels> drawn_first = cache.look_up(queries);
  size_t answered = 0, spared = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    const auto expected = cache.drawn(all[i], queries[i].u, i);
    const auto found = cache.drawn(drawn_first[i], queries[i].u, i);
    ASSERT_EQ(expected.has_value(), found.has_value());
    if (expected) {
      EXPECT_EQ(expected->range_m, found->range_m);
      EXPECT_LT(queries[i].u, cache.greatest_weight(queries[i].near));
    }
    answered += expected.has_value();
    spared += all[i].count > 0 && drawn_first[i].count == 0;
  }
  EXPECT_GT(answered, 100u);
  EXPECT_GT(spared, 1000u);
}

// The share of simulated returns is what the mixture says that `score` judges.
TEST(KeyframeCache, DrawsAreOfTheMixtureThatIsScored) {
  const elements::Model model = fitted(scanned(kDrive, 0, 0.7), 1);
  const BeamLog test = scanned({1.0, 3.3, 5.2}, 100, 0.7);
  const trace::World world(model);
  const KeyframeCache cache(model);
  std::vector<Ray> rays;
  for (size_t i = 0; i < test.size(); ++i) rays.push_back(test.ray(i));
  trace::IntersectionLists met;
  world.all_intersections(rays, {0, 50}, std::vector<double>(rays.size(), 50), met);
  const std::vector<CachedPixels> seen = cache.look_up(cache.queries(rays, test.ring));
  double misses = 0, variance = 0;
  trace::RangeMixture p;
  for (size_t i = 0; i < rays.size(); ++i) {
    trace::mix_ranges(met[i], 1, 1e-6, p);
    cache.mix(seen[i], p);
    misses += p.miss;
    variance += p.miss * (1 - p.miss);
  }
  const trace::World anew(model, trace::Isa::kBest, trace::Draws::kAnew);
  BeamLog drawn = test;
  simulate::simulate(anew, simulate::Options(), 0, drawn);
  size_t missed = 0;
  for (size_t i = 0; i < drawn.size(); ++i) missed += !drawn.is_hit(i);
  EXPECT_NEAR(double(missed), misses, 4 * std::sqrt(variance) + 1);
}

}  // namespace
}  // namespace underbrush::keyframes
