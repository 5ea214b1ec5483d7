#include "studies/extrapolation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace underbrush::studies {
namespace {

/// Scans one metre apart along a curve.
template <class Place>
Path path_along(int scans, const Place& place) {
  std::vector<ScanInfo> info;
  for (int k = 0; k < scans; ++k) {
    ScanInfo s;
    s.scan = uint32_t(k);
    s.world_from_sensor.translation = place(k);
    info.push_back(s);
  }
  return path_of(info);
}

Path straight(int scans) {
  return path_along(scans, [](int k) { return Vec3(k, 0, 0); });
}

TEST(Extrapolation, StretchesAreFollowedByScansAtTheirDistances) {
  const std::vector<Continuation> all = continuations(straight(120));
  ASSERT_EQ(all.size(), 2u);  // From 0 and 50 m; 100 m leaves less than a stretch.
  const Continuation& second = all[1];
  EXPECT_EQ(second.train.size(), 16u);
  EXPECT_EQ(second.train.front(), 50u);
  EXPECT_EQ(second.train.back(), 80u);
  EXPECT_EQ(second.inside, (std::vector<uint32_t>{63, 65, 67}));
  EXPECT_EQ(second.beyond.at(5), (std::vector<uint32_t>{84, 85, 86}));
  EXPECT_EQ(second.beyond.at(20), (std::vector<uint32_t>{99, 100, 101}));
  for (const Continuation& c : all) {
    const std::set<uint32_t> train(c.train.begin(), c.train.end());
    for (const uint32_t scan : c.inside) EXPECT_EQ(train.count(scan), 0u);
    for (const auto& [beyond, scans] : c.beyond) {
      for (const uint32_t scan : scans) EXPECT_GT(scan, c.train.back());
    }
  }
}

TEST(Extrapolation, AShortDriveHasOneStretchAndAStandingSensorNone) {
  const std::vector<Continuation> all = continuations(straight(12));  // 11 m
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].train.back(), 4u);  // Up to 5.5 m, every second scan.
  EXPECT_EQ(all[0].beyond.size(), 1u);
  EXPECT_EQ(all[0].beyond.at(5), (std::vector<uint32_t>{10, 11}));
  EXPECT_TRUE(continuations(path_along(50, [](int) { return Vec3(1, 2, 3); })).empty());
  EXPECT_TRUE(continuations({}).empty());
}

TEST(Extrapolation, ASecondPassIsFoundOnARoundAndNotOnAStraightDrive) {
  EXPECT_FALSE(second_pass(straight(120)));
  const double radius = 60 / (2 * M_PI);
  const Path round = path_along(80, [&](int k) {
    return Vec3(radius * std::cos(k / radius), radius * std::sin(k / radius), 0);
  });
  const std::optional<SecondPass> pass = second_pass(round);
  ASSERT_TRUE(pass);
  // The round of 60 m closes to within 3 m after 57 m.
  EXPECT_NEAR(double(pass->test.front()), 57, 1);
  EXPECT_EQ(pass->test.back(), 79u);
  EXPECT_EQ(pass->train.size(), pass->test.front());
}

}  // namespace
}  // namespace underbrush::studies
