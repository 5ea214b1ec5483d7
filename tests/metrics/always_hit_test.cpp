#include "underbrush/metrics/always_hit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::metrics {
namespace {

BeamLog log_of(const std::vector<uint16_t>& rings, const std::vector<float>& ranges) {
  BeamLog log;
  log.info.max_range_m = 100;
  log.resize(ranges.size());
  log.ring = rings;
  log.range_m = ranges;
  return log;
}

/// The summary of the beams of `real`, answered by the medians of `train`.
Summary scored(const BeamLog& train, const BeamLog& real, size_t chunk = 1000) {
  MemorySource medians_of(train, chunk), beams(real, chunk), truth(real);
  AlwaysHit simulated(RingMedians(medians_of), beams);
  return score(truth, simulated, {}).all;
}

TEST(AlwaysHit, AnswersTheMedianOfTheRing) {
  BeamLog log = log_of({0, 0, 0, 0, 1, 1, 2}, {5, 7, 30, kMiss, 2, kMiss, kMiss});
  MemorySource source(log, 2);
  const RingMedians medians(source);
  EXPECT_EQ(medians.of(0), 7);
  EXPECT_EQ(medians.of(1), 2);
  EXPECT_EQ(medians.of(2), 7) << "no return: the upper median of 2, 5, 7 and 30";
  EXPECT_EQ(medians.of(9), 7);
  log.flags[0] = kMover;
  EXPECT_EQ(RingMedians(source).of(0), 30);
}

TEST(AlwaysHit, OfALogWithoutReturnsMisses) {
  const BeamLog log = log_of({0, 1}, {kMiss, kMiss});
  MemorySource source(log);
  EXPECT_EQ(RingMedians(source).of(0), kMiss);
}

TEST(AlwaysHit, HasTheF1OfTheShareOfHitsAndNoInformedness) {
  BeamLog log = log_of({}, {});
  Stream random(7);
  size_t hits = 0;
  for (size_t i = 0; i < 2000; ++i) {
    const bool hit = random.uniform() < 0.95;
    hits += hit;
    log.append(log_of({uint16_t(i % 4)}, {hit ? float(5 + 20 * random.uniform()) : kMiss}), 0);
  }
  for (const size_t chunk : {1, 333, 5000}) {
    const Summary s = scored(log, log, chunk);
    const double share = double(hits) / 2000;
    EXPECT_DOUBLE_EQ(s.f1, 2 * share / (1 + share));
    EXPECT_EQ(s.informedness, 0);
    EXPECT_EQ(s.f1_of_misses, 0);
    EXPECT_EQ(s.recall_of_misses, 0);
    EXPECT_TRUE(std::isnan(s.precision_of_misses));  // It never misses.
  }
}

TEST(AlwaysHit, TakesTheMediansOfTheLogThatItIsGiven) {
  const BeamLog train = log_of({0, 1}, {10, 20}), real = log_of({0, 1, 1}, {11, 21, 20});
  EXPECT_NEAR(scored(train, real).capped_error_m, 2.0 / 3, 1e-6);
  EXPECT_NEAR(scored(real, real).capped_error_m, 1.0 / 3, 1e-6);
  EXPECT_EQ(always_hit(train, real).range_m, (std::vector<float>{10, 20, 20}));
}

}  // namespace
}  // namespace underbrush::metrics
