#include "studies/echo_counts.hpp"

#include <gtest/gtest.h>

namespace underbrush::studies {
namespace {

/// A floor 1 m below the sensor, 100 m wide.
elements::Model floor_model() {
  elements::Model model;
  model.ground.vertices = {{-50, -50, -1}, {50, -50, -1}, {50, 50, -1}, {-50, 50, -1}};
  model.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  model.ground.hit.resize(2);
  return model;
}

/// Makes a log of level pulses, and of pulses that end on the floor, by their ranges.
BeamLog log_of(const std::vector<std::vector<float>>& pulses, bool on_floor = false) {
  BeamLog log;
  std::vector<uint8_t> echo, echoes;
  for (const std::vector<float>& ranges : pulses) {
    for (size_t k = 0; k < std::max<size_t>(1, ranges.size()); ++k) {
      log.resize(log.size() + 1);
      if (!ranges.empty()) {
        log.range_m.back() = ranges[k];
        const double z = on_floor ? -1 / double(ranges[0]) : 0;
        log.direction.back() = Vec3(std::sqrt(1 - z * z), 0, z).cast<float>();
      }
      echo.push_back(uint8_t(ranges.empty() ? 0 : k + 1));
      echoes.push_back(uint8_t(ranges.size()));
    }
  }
  log.extra[kEchoColumn] = echo;
  log.extra[kEchoesColumn] = echoes;
  return log;
}

TEST(EchoCounts, SharesAreOfThePulsesThatReturn) {
  const EchoCounts c(log_of({{1}, {}, {1, 2}, {5, 6, 7, 9}, {5}, {}}), floor_model());
  EXPECT_DOUBLE_EQ(c.share(2), 0.5);
  EXPECT_DOUBLE_EQ(c.share(3), 0.25);
  EXPECT_DOUBLE_EQ(c.share_in_band(0), 0.5);
  EXPECT_DOUBLE_EQ(c.share_in_band(2), 0.5);
  EXPECT_TRUE(std::isnan(c.share_in_band(1)));
  EXPECT_DOUBLE_EQ(c.share_of_class(false), 0.5);
  EXPECT_TRUE(std::isnan(c.share_of_class(true)));
  EXPECT_EQ(c.gaps(), (std::array<double, 3>{1, 1, 1}));
}

TEST(EchoCounts, APulseThatEndsOnTheFloorIsOnTheGround) {
  const EchoCounts c(log_of({{3}, {4}, {5}}, true), floor_model());
  EXPECT_DOUBLE_EQ(c.share_of_class(true), 0);
  EXPECT_TRUE(std::isnan(c.share_of_class(false)));
}

TEST(EchoCounts, TheDistanceComparesEachClassAndBandByItself) {
  const elements::Model floor = floor_model();
  const EchoCounts real(log_of({{1}, {1}, {1}, {1, 2}, {5}, {5}}), floor);
  EXPECT_DOUBLE_EQ(real.distance(real), 0);
  // More pulses in a band do not count, only their numbers of echoes.
  EXPECT_DOUBLE_EQ(EchoCounts(log_of({{1}, {1}, {1}, {1, 2}, {5}}), floor).distance(real), 0);
  // All of the first band have two echoes instead of a quarter: 3/4 of 4 pulses in 6.
  EXPECT_DOUBLE_EQ(EchoCounts(log_of({{1, 2}, {5}}), floor).distance(real), 0.5);
}

}  // namespace
}  // namespace underbrush::studies
