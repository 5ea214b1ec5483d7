#include "underbrush/credit/trial_times.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
namespace {

TEST(TrialTimes, SpreadIsTheStandardDeviationWhateverTheOrder) {
  TimeSums forth, back, halves[2];
  for (int k = 0; k < 100; ++k) {
    forth.add_shared(0.5 * k);
    back.add_shared(0.5 * (99 - k));
    halves[k % 2].add_shared(0.5 * k);
  }
  EXPECT_NEAR(forth.spread_s(), 0.5 * std::sqrt((100.0 * 100 - 1) / 12), 1e-9);
  EXPECT_EQ(forth.squares, back.squares);
  halves[0].add(halves[1]);
  EXPECT_EQ(halves[0].spread_s(), forth.spread_s());
  EXPECT_EQ(TimeSums().spread_s(), 0);
  TimeSums far;
  for (int k = 0; k < 1000; ++k) far.add_shared(k % 2 ? 1e300 : -1e300);
  EXPECT_DOUBLE_EQ(far.spread_s(), 86400);
}

/// Beams cross an element for ten seconds, and some of them end in it: those of `share` at any
/// time, or all between 4 s and 4.5 s.
TrialTimes crossed(uint64_t seed, bool moves, double share) {
  Stream random(seed);
  TrialTimes out;
  for (int k = 0; k < 400; ++k) {
    const double t = random.uniform(0, 10);
    const bool is_hit = moves ? t > 4 && t < 4.5 : random.uniform() < share;
    (is_hit ? out.hits : out.misses).add_shared(t);
  }
  return out;
}

TEST(TrialTimes, TellWhatMovedFromThinMatter) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    EXPECT_TRUE(crossed(seed, true, 0).are_brief()) << seed;
    EXPECT_FALSE(crossed(seed, false, 0.03).are_brief()) << seed;
    EXPECT_FALSE(crossed(seed, false, 0.9).are_brief()) << seed;
  }
}

TEST(TrialTimes, OfAMomentOrOfOneHitTellNothing) {
  TrialTimes single;
  single.hits.add_shared(3);
  for (int k = 0; k < 100; ++k) single.misses.add_shared(0.1 * k);
  EXPECT_FALSE(single.are_brief());
  TrialTimes moment;
  for (int k = 0; k < 100; ++k) (k < 5 ? moment.hits : moment.misses).add_shared(0.005 * k);
  EXPECT_FALSE(moment.are_brief());
}

}  // namespace
}  // namespace underbrush::credit
