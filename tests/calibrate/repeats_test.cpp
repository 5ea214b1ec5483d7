// The noise of a sensor is found from directions that it repeats.
#include "underbrush/calibrate/repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::calibrate {
namespace {

/// Four scans of 20 rings of 100 beams from a place, or from places `step_m` apart. Of the
/// directions `rough` differ by 0.3 m from scan to scan, as leaves do, and the others by the noise.
BeamLog scans(double noise_m, double rough, double step_m = 0) {
  Stream random(17);
  BeamLog log;
  for (uint32_t s = 0; s < 4; ++s) {
    log.info.scans.push_back({s, 0.1 * s, {}});
    log.info.scans.back().world_from_sensor.translation.x() = step_m * s;
    for (size_t k = 0; k < 2000; ++k) {
      const size_t i = log.size();
      log.resize(i + 1);
      log.direction[i] =
          Vec3(10, 0.05 * double(k % 100), 0.1 * double(k / 100)).normalized().cast<float>();
      log.origin[i] = Vec3(step_m * s, 0, 0);
      log.ring[i] = uint16_t(k / 100);
      log.scan[i] = s;
      const bool is_rough = double((k * 37) % 2000) < 2000 * rough;
      log.range_m[i] = float(10 + (is_rough ? 0.3 : noise_m) * random.normal());
    }
  }
  return log;
}

TEST(RangeNoise, IsThatOfTheSmoothPart) {
  for (const double noise_m : {0.004, 0.02}) {
    const BeamLog of_flat = scans(noise_m, 0), of_leaves = scans(noise_m, 0.3);
    MemorySource flat(of_flat), leaves(of_leaves);
    const Repeats repeats = repeats_of(flat, 1);
    EXPECT_TRUE(repeats.stands);
    EXPECT_EQ(repeats.pairs.size(), 6000u);
    EXPECT_NEAR(range_noise_of(repeats).value() / noise_m, 1, 0.06);
    // With 30 % of leaves the quartile of all is at 36 % of the others, which is 1.46 of it.
    EXPECT_NEAR(range_noise_of(repeats_of(leaves, 1)).value() / noise_m, 1.46, 0.15);
  }
}

TEST(RangeNoise, IsNotBelowWhatLogsResolve) {
  const BeamLog log = scans(0, 0);
  MemorySource still(log);
  EXPECT_EQ(range_noise_of(repeats_of(still, 1)), kLeastNoiseM);
}

TEST(RangeNoise, IsUnknownOfASensorThatMoves) {
  const BeamLog log = scans(0.01, 0, 0.2);
  MemorySource drive(log);
  const Repeats repeats = repeats_of(drive, 1);
  EXPECT_FALSE(repeats.stands);
  EXPECT_EQ(range_noise_of(repeats), std::nullopt);
}

}  // namespace
}  // namespace underbrush::calibrate
