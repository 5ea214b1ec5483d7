#include "underbrush/optimize/slice.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "optimize/logs.hpp"

namespace underbrush::optimize {
namespace {

using Beam = std::pair<uint32_t, double>;  // scan, time: no two beams share both
std::set<Beam> beams_of(const BeamLog& log) {
  std::set<Beam> out;
  for (size_t i = 0; i < log.size(); ++i) out.insert({log.scan[i], log.time_s[i]});
  return out;
}

TEST(Slice, HoldsTheScansOfItsTimeEveryFourthOfThemToValidate) {
  const BeamLog log = test::drive_past_bushes(1, 20, 200);
  MemorySource source(log, 333);
  const Slice slice = take_slice(source, {3, 15, 4, 1});
  EXPECT_EQ(slice.scans, 12u);
  EXPECT_TRUE(slice.by_scan);
  std::set<uint32_t> validating;
  for (const uint32_t s : slice.validation.scan) validating.insert(s);
  EXPECT_EQ(validating, (std::set<uint32_t>{5, 9, 13}));
  EXPECT_EQ(slice.validation.size(), 3u * 200);
  EXPECT_EQ(slice.fit.size(), 9u * 200);
  for (const uint32_t s : slice.fit.scan) {
    EXPECT_TRUE(s >= 3 && s < 15 && !validating.count(s));
  }
}

TEST(Slice, OfFewScansIsCutByGroupsOfBeams) {
  const BeamLog log = test::drive_past_bushes(2, 3, 4000);
  MemorySource source(log, 1000);
  const Slice slice = take_slice(source, {0, 10, 4, 1});
  EXPECT_FALSE(slice.by_scan);
  EXPECT_EQ(slice.fit.size() + slice.validation.size(), log.size());
  EXPECT_NEAR(double(slice.validation.size()) / double(log.size()), 0.25, 0.03);
  std::set<Beam> both = beams_of(slice.fit);
  both.merge(beams_of(slice.validation));
  EXPECT_EQ(both, beams_of(log));
}

TEST(Slice, DoesNotDependOnChunks) {
  const BeamLog log = test::drive_past_bushes(3, 8, 300);
  MemorySource a(log, 97), b(log);
  for (const unsigned one_in : {2u, 3u, 20u}) {
    const Slice x = take_slice(a, {0, 6, one_in, 5}), y = take_slice(b, {0, 6, one_in, 5});
    EXPECT_EQ(x.fit.time_s, y.fit.time_s);
    EXPECT_EQ(x.validation.time_s, y.validation.time_s);
  }
}

TEST(Slice, WithoutBeamsIsRefused) {
  const BeamLog log = test::drive_past_bushes(4, 4, 100);
  MemorySource source(log);
  EXPECT_THROW(take_slice(source, {50, 60, 4, 1}), std::invalid_argument);
  EXPECT_THROW(take_slice(source, {5, 5, 4, 1}), std::invalid_argument);
  EXPECT_THROW(take_slice(source, {0, 10, 1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::optimize
