#include "underbrush/sensor/ring_numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::sensor {
namespace {

constexpr double kDegree = M_PI / 180;

// A VLP-16 stands 2 m above flat ground, with a wall around two thirds of a turn whose upper edge
// is at 10°. Beams above it, and those that would meet the ground beyond 90 m, have no return.
double range_at(const Vec3& d) {
  const double ground = d.z() < 0 ? -2 / d.z() : INFINITY;
  const double azimuth = positive_angle(std::atan2(d.y(), d.x()));
  const double flat = std::hypot(d.x(), d.y());
  const double wall = azimuth < 4 && d.z() < flat * std::tan(10 * kDegree) ? 30 / flat : INFINITY;
  const double range = std::min(ground, wall);
  return range < 90 ? range : INFINITY;
}

struct Scene {
  PointScan scan;
  size_t misses = 0;
};

// The scan ring by ring, with the rings' own numbers; `turn` has the firings of a revolution.
Scene scene_of(const Sensor& sensor, const Pose& pose = {}, int turn = 1808) {
  Scene out;
  out.scan.info.world_from_sensor = pose;
  for (size_t r = 0; r < sensor.channels.size(); ++r) {
    for (int k = 0; k < turn; ++k) {
      const Vec3 d = unit_vector(2 * M_PI * k / turn, sensor.channels[r].elevation_rad);
      const double range = range_at(pose.rotation * d);
      if (!std::isfinite(range)) {
        ++out.misses;
        continue;
      }
      out.scan.point.push_back((range * d).cast<float>());
      out.scan.ring.push_back(uint16_t(r));
    }
  }
  out.scan.intensity.assign(out.scan.size(), 1);
  return out;
}

struct Result {
  BeamLog log;
  BeamCounts counts;
  double lowest = 0;  // z of the lowest direction of a miss
};

Result inferred(const PointScan& scan, const Sensor& sensor) {
  Result out;
  BeamOptions options;
  options.infer_misses = sensor;
  out.log = beams_from_scan(scan, Trajectory(), options, out.counts);
  for (size_t i = 0; i < out.log.size(); ++i) {
    if (!out.log.is_hit(i)) out.lowest = std::min(out.lowest, double(out.log.direction[i].z()));
  }
  return out;
}

PointScan without(const PointScan& scan, const std::function<bool(size_t)>& dropped) {
  PointScan out;
  out.info = scan.info;
  for (size_t i = 0; i < scan.size(); ++i) {
    if (dropped(i)) continue;
    out.point.push_back(scan.point[i]);
    out.ring.push_back(scan.ring[i]);
  }
  out.intensity.assign(out.size(), 1);
  return out;
}

TEST(RingNumbers, MissesAreTheSameHoweverRingsAreNumbered) {
  const Sensor sensor = load("velodyne-vlp16");
  const Scene s = scene_of(sensor);
  const std::vector<uint16_t> fired = sensor.firing_order();
  std::vector<uint16_t> shot(16);
  for (uint16_t k = 0; k < 16; ++k) shot[fired[k]] = k;
  using Number = std::function<int(int)>;
  const std::vector<Number> numbers{[](int r) { return r; },
                                    [](int r) { return r + 1; },
                                    [](int r) { return 15 - r; },
                                    [](int r) { return 16 - r; },
                                    [&](int r) { return int(shot[size_t(r)]); },
                                    [&](int r) { return shot[size_t(r)] + 1; },
                                    [](int) { return 0; },
                                    [](int) { return 7; }};
  for (size_t way = 0; way <= numbers.size(); ++way) {
    SCOPED_TRACE(way);
    PointScan scan = s.scan;
    if (way == numbers.size()) scan.ring.clear();
    for (uint16_t& r : scan.ring) r = uint16_t(numbers[way](r));
    const Result found = inferred(scan, sensor);
    EXPECT_EQ(found.counts.hits, s.scan.size());
    EXPECT_NEAR(double(found.counts.misses_inferred), double(s.misses), 16);
    EXPECT_EQ(found.counts.unknown, 0u);
    EXPECT_GT(found.lowest, -0.03);
    EXPECT_EQ(found.counts.scans_with_rings_renumbered, way >= 1 && way <= 5 ? 1u : 0u);
    std::vector<size_t> count(16);
    for (const uint16_t r : found.log.ring) ++count.at(r);
    for (const size_t n : count) EXPECT_NEAR(double(n), 1808, 2);
  }
}

TEST(RingNumbers, ASilentRingAmongOthersHasNotSeenTheSky) {
  const Sensor sensor = load("velodyne-vlp16");
  const Scene s = scene_of(sensor);
  for (const uint16_t silent : {0, 4}) {  // The lowest one, by the own vehicle; a dead one.
    const PointScan scan = without(s.scan, [&](size_t i) { return s.scan.ring[i] == silent; });
    const Result found = inferred(scan, sensor);
    EXPECT_NEAR(double(found.counts.misses_inferred), double(s.misses), 16);
    EXPECT_EQ(found.counts.unknown, 1808u);
    EXPECT_GT(found.lowest, -0.03);
  }
}

TEST(RingNumbers, UpsideDownAndOnItsSideMissesPointToTheSky) {
  const Sensor sensor = load("velodyne-vlp16");
  for (const double turned : {180.0, 90.0, -90.0, 70.0}) {
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
      SCOPED_TRACE(turned);
      const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(turned * kDegree, axis)), Vec3::Zero()};
      const Scene s = scene_of(sensor, pose);
      const Result found = inferred(s.scan, sensor);
      EXPECT_NEAR(double(found.counts.misses_inferred), double(s.misses), 0.01 * double(s.misses));
      EXPECT_GT(found.lowest, -0.03);
    }
  }
}

TEST(RingNumbers, TwoReturnsOfAPulseAndOtherRatesMakeNoMisses) {
  const Sensor sensor = load("velodyne-vlp16");
  const Scene s = scene_of(sensor);
  PointScan dual;
  for (size_t i = 0; i < s.scan.size(); ++i) {
    for (const float further : {1.0F, 1.05F}) {
      dual.point.push_back(further * s.scan.point[i]);
      dual.ring.push_back(s.scan.ring[i]);
    }
  }
  dual.intensity.assign(dual.size(), 1);
  EXPECT_NEAR(double(inferred(dual, sensor).counts.misses_inferred), double(s.misses), 16);
  for (const int turn : {904, 3616, 180}) {  // 20 and 5 turns a second; a simulator's 2°.
    const Scene other = scene_of(sensor, {}, turn);
    const Result found = inferred(other.scan, sensor);
    EXPECT_NEAR(double(found.counts.misses_inferred), double(other.misses), 16) << turn;
    EXPECT_EQ(found.counts.scans_thinned, 0u);
  }
  Stream random(3);
  const Result thinned =
      inferred(without(s.scan, [&](size_t) { return random.uniform() < 0.75; }), sensor);
  EXPECT_EQ(thinned.counts.scans_thinned, 1u);
}

// Simulators store beams without a return at their greatest range.
TEST(RingNumbers, PointsAtAGivenRangeAreMisses) {
  const Sensor sensor = load("velodyne-vlp16");
  PointScan scan;
  for (size_t r = 0; r < 16; ++r) {
    for (int k = 0; k < 360; ++k) {
      const Vec3 d = unit_vector(k * kDegree, sensor.channels[r].elevation_rad);
      scan.point.push_back((std::min(120.0, range_at(d)) * d).cast<float>());
      scan.ring.push_back(uint16_t(r));
    }
  }
  scan.intensity.assign(scan.size(), 1);
  BeamOptions options;
  options.no_return_at_m = 120;
  BeamCounts counts;
  const BeamLog log = beams_from_scan(scan, Trajectory(), options, counts);
  ASSERT_EQ(log.size(), scan.size());
  EXPECT_EQ(counts.misses_recorded, scene_of(sensor, {}, 360).misses);
  EXPECT_TRUE(log.info.has_misses);
  for (size_t i = 0; i < log.size(); ++i) {
    EXPECT_EQ(log.is_hit(i), scan.point[i].norm() < 100);
    EXPECT_LT((log.direction[i] - scan.point[i].normalized()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace underbrush::sensor
