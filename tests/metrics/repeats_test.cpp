#include "underbrush/metrics/repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/scan_pairs.hpp"

namespace underbrush::metrics {
namespace {

constexpr int kScans = 10, kBearings = 1000;
constexpr double kBearingStep = 0.2 * M_PI / 180;

/// Scans of a round wall about a standing sensor that turns by `turn` between scans, with normal
/// noise, and with the wall `creep` farther away each scan.
BeamLog repeated(double sigma, uint64_t seed, double turn = 0, double creep = 0) {
  BeamLog log;
  log.info.has_misses = true;
  log.resize(kScans * kBearings);
  for (size_t i = 0; i < log.size(); ++i) {
    const auto scan = uint32_t(i / kBearings);
    const double angle = double(i % kBearings) * kBearingStep + turn * scan;
    log.scan[i] = scan;
    log.direction[i] = Vec3f(float(std::cos(angle)), float(std::sin(angle)), 0);
    log.range_m[i] =
        float(10 + creep * scan + sigma * normal(beam_key(seed, scan, i), 0, Purpose::kNoise));
  }
  for (uint32_t scan = 0; scan < kScans; ++scan) {
    ScanInfo info;
    info.scan = scan;
    info.world_from_sensor.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(turn * scan, Vec3::UnitZ()));
    log.info.scans.push_back(info);
  }
  return log;
}

Repeats repeats_of(const BeamLog& real, const BeamLog& simulated, size_t chunk = 1000) {
  MemorySource a(real, chunk), b(simulated, chunk / 2);
  return repeats(a, b);
}

// The difference of two normal numbers has a median size of 0.6745 √2 σ.
TEST(Repeats, DifferenceOfNormalNoiseIsItsClosedForm) {
  const double sigma = 0.02;
  const Repeats s = repeats_of(repeated(sigma, 1), repeated(2 * sigma, 2));
  EXPECT_EQ(s.scans, size_t(kScans));
  EXPECT_EQ(s.directions, size_t(kBearings * (kScans - 1)));
  // 9 000 differences: the median is known to 1.3 % (σ).
  EXPECT_NEAR(s.real_difference_m / (0.6745 * std::sqrt(2) * sigma), 1, 0.06);
  EXPECT_NEAR(s.difference_m / s.real_difference_m, 2, 0.15);
  EXPECT_TRUE(s.repeat());
}

TEST(Repeats, OnlyTheRightSpreadReachesTheFloor) {
  const BeamLog real = repeated(0.02, 1);
  const Repeats good = repeats_of(real, repeated(0.02, 2));
  EXPECT_GT(good.floor, 0);
  EXPECT_NEAR(good.distance / good.floor, 1, 0.1);
  EXPECT_GT(repeats_of(real, repeated(0, 2)).distance, 1.3 * good.floor);
  EXPECT_GT(repeats_of(real, repeated(0.06, 2)).distance, 1.3 * good.floor);
  BeamLog biased = repeated(0.02, 2);
  for (float& range : biased.range_m) range += 0.05f;
  EXPECT_GT(repeats_of(real, biased).distance, 1.3 * good.floor);
  EXPECT_EQ(repeats_of(real, real).same_scans, 0);
}

TEST(Repeats, DirectionsAreThoseOfTheSensor) {
  const Repeats still = repeats_of(repeated(0.02, 1), repeated(0.02, 2));
  // The sensor turns by five bins a scan, and so do its beams.
  const Repeats turned =
      repeats_of(repeated(0.02, 1, 5 * kBearingStep), repeated(0.02, 2, 5 * kBearingStep));
  EXPECT_EQ(turned.directions, still.directions);
  EXPECT_NEAR(turned.real_difference_m, still.real_difference_m, 1e-6);
}

TEST(Repeats, ScansOfAMovingSensorDoNotRepeat) {
  const Repeats s = repeats_of(repeated(0.005, 1, 0, 0.02), repeated(0.005, 2, 0, 0.02));
  EXPECT_NEAR(s.real_difference_m, 0.02, 0.003);
  EXPECT_NEAR(s.real_far_difference_m, 0.1, 0.01);
  EXPECT_FALSE(s.repeat());
}

TEST(Repeats, DoNotDependOnChunks) {
  const BeamLog real = repeated(0.02, 1), simulated = repeated(0.02, 2);
  const Repeats a = repeats_of(real, simulated, 100000), b = repeats_of(real, simulated, 34);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.difference_m, b.difference_m);
}

TEST(Repeats, OtherBeamsAreRefused) {
  const BeamLog real = repeated(0.02, 1);
  BeamLog other = real, shorter = real;
  other.ring[5000] = 3;
  shorter.resize(100);
  EXPECT_THROW(repeats_of(real, other), DataError);
  EXPECT_THROW(repeats_of(real, shorter), DataError);
}

TEST(BearingRange, SumOfHistogramsIsTheHistogramOfAllBeams) {
  const BeamLog a = repeated(0.02, 1), b = repeated(0.03, 2);
  BearingRangeHistogram ha, hb, all;
  ha.add(a);
  hb.add(b);
  all.add(a);
  all.add(b);
  ha.add(hb);
  EXPECT_EQ(ha.total(), all.total());
  ASSERT_EQ(ha.occupied().size(), all.occupied().size());
  EXPECT_EQ(bhattacharyya_distance(ha, all), 0);
}

}  // namespace
}  // namespace underbrush::metrics
