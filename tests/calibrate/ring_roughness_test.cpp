#include "underbrush/calibrate/ring_roughness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::calibrate {
namespace {

BeamLog ring_of(const std::vector<float>& ranges) {
  BeamLog log;
  log.resize(ranges.size());
  log.range_m = ranges;
  return log;
}

TEST(RingRoughness, IsTheSecondDifferenceOfThreeHitsInARow) {
  RingRoughness r;
  r.add(ring_of({5, 6, 9, 12, kMiss, 3, 4, 5}));
  EXPECT_EQ(r.count(), 3u);  // 2, 0, and 0 after the miss
  EXPECT_EQ(r.quantile(1), 2);
  EXPECT_EQ(r.median(), 0);
  EXPECT_NEAR(r.geometric_mean(), std::cbrt(2.005 * 0.005 * 0.005) - 0.005, 1e-7);
}

TEST(RingRoughness, RingsScansAndGroupsAreApart) {
  BeamLog log = ring_of({1, 50, 2, 60, 4, 80, 8, 90});
  for (size_t i = 0; i < log.size(); ++i) log.ring[i] = uint16_t(i % 2);
  RingRoughness r;
  r.add(log);
  EXPECT_EQ(r.count(), 4u);
  EXPECT_EQ(r.quantile(0), 1);   // 4 − 2·2 + 1
  EXPECT_EQ(r.quantile(1), 10);  // 80 − 2·60 + 50 and 90 − 2·80 + 60
  for (size_t i = 4; i < log.size(); ++i) log.scan[i] = 1;
  RingRoughness scans;
  scans.add(log);
  EXPECT_EQ(scans.count(), 0u);
  RingRoughness groups;
  log.scan.assign(log.size(), 0);
  groups.add(log, std::vector<uint8_t>{3, 0, 3, 0, 3, 0, 3, 1});
  EXPECT_EQ(groups.count(3), 2u);
  EXPECT_EQ(groups.count(0), 1u);
  EXPECT_EQ(groups.count(1), 1u);  // of beams of groups 0 and 1
  EXPECT_TRUE(std::isnan(groups.median(2)));
}

TEST(RingRoughness, ChunksChangeNothingAndOfEchoesTheFirstCounts) {
  Stream random(4);
  std::vector<float> ranges(1000);
  for (float& range : ranges) range = float(10 + random.normal());
  const BeamLog whole = ring_of(ranges);
  RingRoughness one, pieces;
  one.add(whole);
  for (size_t from = 0; from < whole.size(); from += 37) {
    BeamLog piece = whole.like();
    piece.append(whole, from, std::min(whole.size(), from + 37));
    pieces.add(piece);
  }
  EXPECT_EQ(one.count(), pieces.count());
  EXPECT_EQ(one.median(), pieces.median());
  // The median for independent normal numbers is 0.6745 √6 σ.
  EXPECT_NEAR(one.median(), 1.652, 0.15);
}

}  // namespace
}  // namespace underbrush::calibrate
