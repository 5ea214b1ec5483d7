#include "underbrush/sensor/pattern.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "underbrush/core/parallel.hpp"
#include "underbrush/sensor/angles.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kSpeed = 15, kTurnRate = 0.4;

Pose moving(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(kTurnRate * t, Vec3::UnitZ())),
          Vec3(kSpeed * t, 2, 1.8)};
}

Trajectory path(double start, double end) {
  std::vector<StampedPose> poses;
  for (double t = start; t <= end + 0.05; t += 0.1) poses.push_back({t, moving(t)});
  return Trajectory(poses);
}

TEST(Pattern, EverySensorFiresItsBeamsPerRevolutionAndPerChannel) {
  const Trajectory still({{0, Pose{}}});
  for (const std::string& name : names()) {
    const Sensor s = load(name);
    if (s.kind != Kind::kSpinning) continue;
    const BeamLog log = beams(s, still, 5, 5 + 2 / s.rate_hz);
    log.check();
    const double expected = 2 * s.firings_per_revolution() * double(s.channels.size());
    EXPECT_NEAR(double(log.size()), expected, double(s.channels.size())) << name;
    EXPECT_EQ(log.info.scans.size(), 2u) << name;
    std::vector<size_t> by_ring(s.channels.size()), by_scan(2);
    for (size_t i = 0; i < log.size(); ++i) {
      ASSERT_FALSE(log.is_hit(i));
      ASSERT_NEAR(log.direction[i].norm(), 1, 1e-6);
      ASSERT_NEAR(std::asin(log.direction[i].z()), s.channels[log.ring[i]].elevation_rad, 1e-6);
      const double firings =
          (log.time_s[i] - 5 - s.channels[log.ring[i]].time_s) / s.firing_period_s;
      ASSERT_NEAR(firings, std::round(firings), 1e-6) << "a channel fires at its own time";
      if (i > 0) {
        ASSERT_GE(log.time_s[i], log.time_s[i - 1]);
      }
      ++by_ring[log.ring[i]];
      ++by_scan[log.scan[i]];
    }
    for (size_t n : by_ring) EXPECT_NEAR(double(n), 2 * s.firings_per_revolution(), 1) << name;
    for (size_t n : by_scan) {
      EXPECT_NEAR(double(n), expected / 2, double(s.channels.size())) << name;
    }
  }
}

TEST(Pattern, TurnsClockwiseFromItsStartAtTheRateOfTheHead) {
  Sensor s = load("velodyne-vlp16");
  const Trajectory still({{0, Pose{}}});
  for (bool clockwise : {true, false}) {
    s.clockwise = clockwise;
    const BeamLog log = beams(s, still, 100, 100.1);
    for (size_t i = 0; i < log.size(); i += 97) {
      const double turned = (log.time_s[i] - 100) * s.rate_hz * 2 * M_PI;
      const double expected = s.start_azimuth_rad + (clockwise ? -turned : turned);
      const double azimuth = std::atan2(log.direction[i].y(), log.direction[i].x());
      ASSERT_NEAR(std::remainder(azimuth - expected, 2 * M_PI), 0, 1e-6);
    }
  }
}

TEST(Pattern, OriginAndDirectionFollowTheMotionWithinARevolution) {
  const Sensor s = load("velodyne-hdl64e");
  const Trajectory trajectory = path(0, 1);
  const BeamLog log = beams(s, trajectory, 0.2, 0.4);
  EXPECT_TRUE(log.info.deskewed);
  for (size_t i = 0; i < log.size(); i += 31) {
    const Pose pose = moving(log.time_s[i]);
    const Channel& c = s.channels[log.ring[i]];
    ASSERT_LT((log.origin[i] - pose * Vec3(0, 0, c.z_m)).norm(), 1e-9);
    const Vec3 local = pose.rotation.conjugate() * log.direction[i].cast<double>();
    const double azimuth = s.start_azimuth_rad - 2 * M_PI * s.rate_hz * (log.time_s[i] - 0.2);
    ASSERT_NEAR(std::remainder(std::atan2(local.y(), local.x()) - azimuth, 2 * M_PI), 0, 1e-6);
  }
}

TEST(Pattern, PacketsHoldTheMakersNumberOfBeams) {
  const Sensor s = load("velodyne-hdl32e");
  const BeamLog log = beams(s, Trajectory({{0, Pose{}}}), 0, 0.1);
  std::vector<size_t> count(log.packet.back() + 1);
  for (uint32_t p : log.packet) ++count[p];
  for (size_t k = 0; k + 1 < count.size(); ++k) EXPECT_EQ(count[k], 384u);
}

TEST(Pattern, ChunksAndThreadsChangeNothing) {
  const Sensor s = load("velodyne-vlp32c");
  const Trajectory trajectory = path(0, 1);
  const double end = 0.2 + 40 * s.firing_period_s + 10e-6;  // ends within a firing
  const BeamLog whole = beams(s, trajectory, 0.2, end);
  EXPECT_LT(whole.time_s.back(), end);
  EXPECT_EQ(whole.size(), 40 * 32 + 10u);  // pairs at 0, 2.304, … 9.216 µs
  set_threads(1);
  PatternSource source(s, trajectory, 0.2, end, 100);
  EXPECT_EQ(source.size(), whole.size());
  for (int pass = 0; pass < 2; ++pass) {
    BeamLog joined, chunk;
    source.rewind();
    while (source.next(chunk)) joined.append(chunk, 0, chunk.size());
    EXPECT_EQ(joined.origin, whole.origin);
    EXPECT_EQ(joined.direction, whole.direction);
    EXPECT_EQ(joined.time_s, whole.time_s);
    EXPECT_EQ(joined.ring, whole.ring);
    EXPECT_EQ(joined.packet, whole.packet);
  }
  set_threads(0);
}

// The shots of a cycle repeat, each at its own time, whatever the chunks. A scan is 1/rate long.
TEST(Pattern, SensorsThatDoNotSpinRepeatTheirCycle) {
  const Trajectory trajectory = path(0, 200);
  for (const std::string& name : names()) {
    const Sensor s = load(name);
    if (s.kind == Kind::kSpinning) continue;
    const double cycles = std::min(2.25, 5e5 / double(s.shots_per_cycle()));
    const double end = 3 + cycles * s.shot_cycle_s();
    const BeamLog log = beams(s, trajectory, 3, end);
    log.check();
    const uint64_t n = s.shots_per_cycle();
    // Shots are evenly spaced, except that a sweep pauses for the rest of its turn.
    if (s.channels.empty()) {
      EXPECT_NEAR(double(log.size()), cycles * double(n), 1) << name;
    }
    for (size_t i = 0; i < log.size(); i += 7) {
      const Shot shot = s.shot(i % n);
      ASSERT_NEAR(log.time_s[i], 3 + double(i / n) * s.shot_cycle_s() + shot.time_s, 1e-9);
      ASSERT_EQ(log.ring[i], shot.ring);
      ASSERT_EQ(log.scan[i], uint32_t((log.time_s[i] - 3 + 1e-9) * s.rate_hz)) << name << i;
      const Vec3 local =
          moving(log.time_s[i]).rotation.conjugate() * log.direction[i].cast<double>();
      ASSERT_LT((local - unit_vector(shot.azimuth_rad, shot.elevation_rad)).norm(), 1e-6);
      ASSERT_LT((log.origin[i] - moving(log.time_s[i]).translation).norm(), 1e-9);
    }
    EXPECT_LT(log.time_s.back(), end);
    EXPECT_EQ(log.info.scans.size(), log.scan.back() + 1);
    for (const ScanInfo& scan : log.info.scans) {
      const size_t first =
          size_t(std::lower_bound(log.scan.begin(), log.scan.end(), scan.scan) - log.scan.begin());
      EXPECT_NEAR(scan.time_s, log.time_s[first], 1e-9) << name;
      EXPECT_EQ(log.packet[first], 0u);
    }
    PatternSource source(s, trajectory, 3, end, 333);
    ASSERT_EQ(source.size(), log.size());
    BeamLog joined, chunk;
    while (source.next(chunk)) joined.append(chunk, 0, chunk.size());
    EXPECT_EQ(joined.direction, log.direction);
    EXPECT_EQ(joined.packet, log.packet);
  }
}

TEST(Pattern, APartHasTheBeamsOfTheWhole) {
  const Trajectory trajectory = path(0, 1);
  for (const char* name : {"velodyne-hdl32e", "livox-mid360"}) {
    const Sensor s = load(name);
    const BeamLog log = beams(s, trajectory, 0.1, 0.25);
    PatternSource source(s, trajectory, 0.1, 0.25, 500);
    for (const size_t first : {size_t(0), size_t(1), size_t(777), log.size() - 1, log.size()}) {
      const size_t end = std::min(first + 1001, log.size());
      BeamWindow window(source, first, end);
      window.rewind();
      BeamLog joined, chunk;
      while (window.next(chunk)) joined.append(chunk, 0, chunk.size());
      ASSERT_EQ(joined.size(), end - first) << name;
      for (size_t i = 0; i < joined.size(); ++i) {
        ASSERT_EQ(joined.direction[i], log.direction[first + i]) << name;
        ASSERT_EQ(joined.time_s[i], log.time_s[first + i]) << name;
        ASSERT_EQ(joined.packet[i], log.packet[first + i]) << name;
      }
    }
    EXPECT_GT(source.seek(log.size() / 2) + s.channels.size() + 1, log.size() / 2) << name;
  }
}

TEST(Pattern, RasterRunsThereAndBackBetweenItsBounds) {
  const Raster r{0.2, -0.2, 0.1, -0.1, 5, 3, false, true};
  EXPECT_EQ(r.size(), 15u);
  const double azimuth[] = {0.2, 0.1, 0, -0.1, -0.2, -0.2, -0.1, 0, 0.1, 0.2, 0.2};
  for (uint64_t k = 0; k < 11; ++k) {
    EXPECT_NEAR(r.shot(k).azimuth_rad, azimuth[k], 1e-12);
    EXPECT_NEAR(r.shot(k).elevation_rad, 0.1 - 0.1 * double(k / 5), 1e-12);
    EXPECT_EQ(r.shot(k).ring, k / 5);
  }
  const Raster c{0.2, -0.2, 0.1, -0.1, 5, 3, true, false};
  EXPECT_NEAR(c.shot(4).azimuth_rad, 0.1, 1e-12);
  EXPECT_EQ(c.shot(4).ring, 1u);
}

TEST(Pattern, LayersOfASweepKeepToTheirWindows) {
  const Sensor lux = load("ibeo-lux-2010");
  std::array<double, 4> low{9, 9, 9, 9}, high{-9, -9, -9, -9};
  std::array<size_t, 4> count{};
  for (const Shot& s : lux.shots) {
    low[s.ring] = std::min(low[s.ring], s.azimuth_rad * 180 / M_PI);
    high[s.ring] = std::max(high[s.ring], s.azimuth_rad * 180 / M_PI);
    ++count[s.ring];
    // The head turns at a constant rate: 0.5 degrees in 1/720 of 80 ms.
    EXPECT_NEAR(s.time_s, (50.25 * M_PI / 180 - s.azimuth_rad) / (2 * M_PI) * 0.08, 1e-9);
  }
  EXPECT_EQ(count[0], 202u);
  EXPECT_NEAR(low[0], -50.25, 1e-9);
  EXPECT_NEAR(high[0], 50.25, 1e-9);
  EXPECT_NEAR(low[3], -59.75, 1e-9);
  EXPECT_NEAR(high[3], 35.75, 1e-9);
}

TEST(Pattern, RefusesWhatHasNoPoseAndGivesNothingForNoTime) {
  const Sensor s = load("velodyne-vlp16");
  const Trajectory trajectory = path(0, 1);
  EXPECT_THROW(beams(s, trajectory, 5, 5.1), std::invalid_argument);
  EXPECT_THROW(beams(s, trajectory, 1, 0), std::invalid_argument);
  EXPECT_THROW(beams(s, trajectory, 0, INFINITY), std::invalid_argument);
  EXPECT_TRUE(beams(s, trajectory, 0.5, 0.5).empty());
}

}  // namespace
}  // namespace underbrush::sensor
