#include "underbrush/sensor/beams_from_scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/sensor/rings.hpp"

namespace underbrush::sensor {
namespace {

Trajectory driving() {
  std::vector<StampedPose> poses;
  for (int k = 0; k <= 10; ++k) {
    const double t = 0.1 * k;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5 * t, Vec3::UnitZ()));
    const Eigen::Quaterniond pitch(Eigen::AngleAxisd(0.05 * t, Vec3::UnitY()));
    poses.push_back({t, {turn * pitch, Vec3(19 * t, t, 1.8)}});
  }
  return Trajectory(poses);
}

double mod_azimuth(const Vec3f& p) {
  const double a = std::atan2(double(p.y()), double(p.x()));
  return a < 0 ? a + 2 * M_PI : a;
}

// A revolution as a format without poses stores it: the end points of the beams in the frame of the
// sensor at each beam's own time, ring by ring with rising azimuth, as in KITTI. `range` gives the
// range of a beam, or infinity.
struct Synthetic {
  PointScan scan;
  BeamLog truth;               // in the same order, misses included
  std::vector<size_t> stored;  // beam of each point
};

template <class F>
Synthetic synthetic(const Sensor& sensor, const Trajectory& trajectory, double start_s, F range) {
  const BeamLog log = beams(sensor, trajectory, start_s, start_s + 1 / sensor.rate_hz);
  Synthetic out;
  out.scan.info = {7, start_s + 0.5 / sensor.rate_hz,
                   *trajectory.at(start_s + 0.5 / sensor.rate_hz)};
  std::vector<size_t> order(log.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::vector<Vec3f> local(log.size());
  for (size_t i = 0; i < log.size(); ++i) {
    const Pose sensor_from_world = trajectory.at(log.time_s[i])->inverse();
    const double r = range(log, i);
    local[i] = (sensor_from_world.rotation * log.direction[i].cast<double>()).cast<float>();
    if (!std::isfinite(r)) continue;
    local[i] =
        (sensor_from_world * (log.origin[i] + r * log.direction[i].cast<double>())).cast<float>();
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (log.ring[a] != log.ring[b]) return log.ring[a] < log.ring[b];
    return mod_azimuth(local[a]) < mod_azimuth(local[b]);
  });
  for (size_t i : order) {
    out.truth.append(log, i);
    const double r = range(log, i);
    out.truth.range_m.back() = float(r);
    if (!std::isfinite(r)) continue;
    out.stored.push_back(out.truth.size() - 1);
    out.scan.point.push_back(local[i]);
  }
  out.scan.intensity.assign(out.scan.point.size(), 0.5f);
  return out;
}

double range_to_ground(const BeamLog& log, size_t i) {
  const double down = -log.direction[i].z();
  return down > 0.03 ? log.origin[i].z() / down : INFINITY;
}

TEST(BeamsFromScan, DeskewBringsAPlaneSeenWhileDrivingBackToThePlane) {
  const Sensor sensor = load("velodyne-hdl64e");
  const Trajectory trajectory = driving();
  Synthetic s = synthetic(sensor, trajectory, 0.4, range_to_ground);
  s.scan.ring.resize(s.scan.size());
  for (size_t k = 0; k < s.scan.size(); ++k) s.scan.ring[k] = s.truth.ring[s.stored[k]];
  for (double fault_deg : {0.0, 0.205}) {
    PointScan scan = s.scan;
    for (Vec3f& p : scan.point) {  // the fault lowers every ray
      const Vec3 d = p.cast<double>();
      const Vec3 axis = d.cross(Vec3::UnitZ()).normalized();
      p = (Eigen::AngleAxisd(-fault_deg * kDegree, axis) * d).cast<float>();
    }
    BeamOptions options;
    options.deskew = sensor;
    options.elevation_offset_rad = fault_deg * kDegree;
    BeamCounts counts;
    const BeamLog log = beams_from_scan(scan, trajectory, options, counts);
    log.check();
    ASSERT_EQ(log.size(), scan.size());
    EXPECT_EQ(counts.hits, scan.size());
    EXPECT_TRUE(log.info.deskewed);
    double worst = 0, travelled = 0;
    for (size_t i = 0; i < log.size(); ++i) {
      // The beams straight to the rear may be the first or the last of the revolution.
      const bool rear = std::abs(log.time_s[i] - scan.info.time_s) > 0.05 - 1e-6;
      if (!rear && log.range_m[i] < 60) worst = std::max(worst, std::abs(log.end_point(i).z()));
      travelled = std::max(travelled, (log.origin[i] - log.origin[0]).norm());
      if (i > 0) {
        ASSERT_GE(log.time_s[i], log.time_s[i - 1]);
      }
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_NEAR(travelled, 1.9, 0.01);

    // Without deskewing all beams share a pose, and the ground is no longer a plane.
    options.deskew.reset();
    const BeamLog skewed = beams_from_scan(scan, trajectory, options, counts);
    EXPECT_FALSE(skewed.info.deskewed);
    worst = 0;
    for (size_t i = 0; i < skewed.size(); ++i) {
      if (skewed.range_m[i] < 60) worst = std::max(worst, std::abs(skewed.end_point(i).z()));
      ASSERT_EQ(skewed.origin[i], scan.info.world_from_sensor.translation);
    }
    EXPECT_GT(worst, 1e-3);
  }
}

// Computes the distance of `a` to the nearest of sorted azimuths, or infinity if it is above 0.01.
double distance_to_nearest(const std::vector<double>& sorted, double a) {
  double nearest = INFINITY;
  for (auto it = std::lower_bound(sorted.begin(), sorted.end(), a - 0.01); it != sorted.end();
       ++it) {
    nearest = std::min(nearest, std::abs(*it - a));
    if (*it > a + 0.01) break;
  }
  return nearest;
}

// A full scan sees a wall all around and loses some returns. The inferred misses must be the lost
// returns.
TEST(BeamsFromScan, InferredMissesAreTheDroppedOnes) {
  const Sensor sensor = load("velodyne-hdl64e");
  const Trajectory still({{0, Pose{}}});
  Stream random(11);
  std::vector<uint8_t> dropped;
  const auto wall = [&](const BeamLog& log, size_t i) {
    if (dropped.empty()) {
      dropped.resize(log.size());
      for (size_t k = 0; k < log.size(); ++k) {
        const double azimuth = std::atan2(log.direction[k].y(), log.direction[k].x());
        dropped[k] = random.uniform() < 0.1 || std::abs(azimuth) < 0.1 || std::abs(azimuth) > 3.1;
      }
    }
    return dropped[i] ? INFINITY : 20.0;
  };
  const Synthetic s = synthetic(sensor, still, 0, wall);
  BeamOptions options;
  options.infer_misses = sensor;
  options.deskew = sensor;
  options.unknown_below_rad = -2;
  BeamCounts counts;
  const BeamLog log = beams_from_scan(s.scan, still, options, counts);
  EXPECT_EQ(counts.scans_ringed_by_elevation, 0u);
  EXPECT_EQ(log.info.scans[0].scan, 7u);
  EXPECT_TRUE(log.has_misses());

  // Both are sorted by ring and azimuth, and each lost beam is compared with the nearest inferred
  // one.
  std::vector<std::vector<double>> inferred(64);
  size_t misses = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    ASSERT_EQ(log.is_hit(i), log.flags[i] == 0);
    if (log.is_hit(i)) continue;
    ++misses;
    ASSERT_EQ(log.intensity[i], 0);
    inferred[log.ring[i]].push_back(mod_azimuth(log.direction[i]));
    // A miss is raised to the apparent elevation of its neighbours.
    const Channel& c = sensor.channels[log.ring[i]];
    ASSERT_NEAR(std::asin(log.direction[i].z()),
                c.elevation_rad + std::asin(c.z_m * std::cos(c.elevation_rad) / 20), 1e-3);
    // The miss was fired when the head pointed there.
    ASSERT_NEAR(log.time_s[i],
                s.scan.info.time_s -
                    std::remainder(mod_azimuth(log.direction[i]), 2 * M_PI) / (2 * M_PI) * 0.1,
                1e-7);
  }
  size_t found = 0, total = 0;
  for (auto& ring : inferred) std::sort(ring.begin(), ring.end());
  for (size_t i = 0; i < s.truth.size(); ++i) {
    if (s.truth.is_hit(i)) continue;
    ++total;
    const double nearest =
        distance_to_nearest(inferred[s.truth.ring[i]], mod_azimuth(s.truth.direction[i]));
    found += nearest < 0.5 * sensor.azimuth_step_rad();
  }
  EXPECT_EQ(counts.misses_inferred, misses);
  EXPECT_NEAR(double(misses), double(total), 0.005 * double(total));
  EXPECT_GT(double(found), 0.99 * double(total));
}

TEST(BeamsFromScan, RingsBelowTheThresholdAreUnknownNotMisses) {
  const Sensor sensor = load("velodyne-hdl64e");
  const Trajectory still({{0, Pose{}}});
  const auto range = [](const BeamLog& log, size_t i) {  // a block of 0.2 rad is lost in each ring
    return std::abs(std::atan2(log.direction[i].y(), log.direction[i].x()) - 1) < 0.1 ? INFINITY
                                                                                      : 9.0;
  };
  const Synthetic s = synthetic(sensor, still, 0, range);
  BeamOptions options;
  options.infer_misses = sensor;
  BeamCounts counts;
  const BeamLog log = beams_from_scan(s.scan, still, options, counts);
  const double block = 0.2 / sensor.azimuth_step_rad();
  EXPECT_NEAR(double(counts.unknown), 23 * block, 23 * 1.5);  // rings 41 … 63
  EXPECT_NEAR(double(counts.misses_inferred), 41 * block, 41 * 1.5);
  for (size_t i = 0; i < log.size(); ++i) EXPECT_TRUE(log.is_hit(i) || log.ring[i] < 41);
}

TEST(Rings, ByElevationAreTheSensorsEvenCloseToIt) {
  const Sensor sensor = load("velodyne-hdl64e");
  const Trajectory still({{0, Pose{}}});
  const auto range = [](const BeamLog&, size_t i) { return 2.0 + double(i % 50); };
  Synthetic s = synthetic(sensor, still, 0, range);
  const std::vector<uint16_t> rings = rings_from_elevation(s.scan.point, sensor, 0);
  for (size_t k = 0; k < rings.size(); ++k) ASSERT_EQ(rings[k], s.truth.ring[s.stored[k]]);

  // Points in an order that is no ring order are assigned by elevation, and counted.
  std::reverse(s.scan.point.begin(), s.scan.point.end());
  BeamOptions options;
  options.deskew = sensor;
  BeamCounts counts;
  const BeamLog log = beams_from_scan(s.scan, still, options, counts);
  EXPECT_EQ(counts.scans_ringed_by_elevation, 1u);
  std::vector<size_t> count(64);
  for (uint16_t r : log.ring) ++count[r];
  for (size_t n : count) EXPECT_NEAR(double(n), sensor.firings_per_revolution(), 2);
}

// A small organised cloud has azimuths in counts of 0.01°, and some returns are blanked. Their
// directions must be recovered.
TEST(BeamsFromScan, MissesOfAnOrganisedCloudGetTheirDirectionFromTheGrid) {
  const size_t rows = 16, columns = 210;
  Stream random(5);
  for (bool column_major : {true, false}) {
    PointScan scan;
    std::vector<Vec3> truth;
    std::vector<uint8_t> blank;
    for (size_t i = 0; i < rows * columns; ++i) {
      const size_t r = column_major ? i % rows : i / columns;
      const size_t c = column_major ? i / rows : i % columns;
      const double a = 1 - 2 * M_PI * double(c) / columns + 0.05 * double(r % 4);
      const double e = 0.3 - 0.04 * double(r);
      truth.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      const double range = random.uniform(3, 50), counts = std::round(a / kDegree * 100);
      const double stored = counts / 100 * kDegree;
      const Vec3 seen(std::cos(e) * std::cos(stored), std::cos(e) * std::sin(stored), std::sin(e));
      blank.push_back(random.uniform() < 0.5 || r == 13);  // one ring is without any return
      scan.point.push_back(blank.back() ? (column_major ? Vec3f::Zero() : Vec3f::Constant(NAN))
                                        : Vec3f((range * seen).cast<float>()));
    }
    scan.intensity.assign(scan.size(), 1);
    scan.extra["label"] = std::vector<uint16_t>(scan.size(), 3);
    BeamCounts counts;
    const BeamLog log = beams_from_scan(scan, Trajectory(), {}, counts);
    log.check();
    ASSERT_EQ(log.size(), scan.size());
    EXPECT_EQ(counts.misses_recorded, size_t(std::count(blank.begin(), blank.end(), 1)));
    EXPECT_EQ(counts.hits, scan.size() - counts.misses_recorded);
    EXPECT_TRUE(log.has_misses());
    for (size_t i = 0; i < log.size(); ++i) {
      ASSERT_EQ(log.is_hit(i), !blank[i]);
      ASSERT_EQ(log.ring[i], column_major ? i % rows : i / columns);
      ASSERT_LT((log.direction[i].cast<double>() - truth[i]).norm(), 2e-4) << i;
      ASSERT_EQ(log.flags[i], 0);
    }
    EXPECT_EQ(std::get<std::vector<uint16_t>>(log.extra.at("label"))[0], 3);
  }
}

TEST(BeamsFromScan, WhatSaysNothingIsLeftOutAndCounted) {
  const Sensor sensor = load("velodyne-vlp16");
  PointScan scan;
  scan.point = {Vec3f(5, 0, 0), Vec3f(0, NAN, 0), Vec3f::Zero(), Vec3f(0.1f, 0, 0),
                Vec3f(0, 900, 0)};
  scan.intensity.assign(5, 1);
  scan.ring.assign(5, 3);
  scan.time_s = {0, 0, 0, 0, 0.01};
  BeamOptions options;
  options.deskew = sensor;
  BeamCounts counts;
  const Trajectory still({{0, Pose{}}});
  EXPECT_EQ(beams_from_scan(scan, still, options, counts).size(), 2u);
  EXPECT_EQ(counts.hits, 2u);
  EXPECT_EQ(counts.skipped.at("no coordinates, and no grid that gives the direction"), 2u);
  EXPECT_EQ(counts.skipped.at("nearer than the sensor's minimum range"), 1u);

  scan.time_s = {0, 0, 0, 0, 99};
  const Trajectory path({{0, Pose{}}, {1, Pose{}}});
  EXPECT_EQ(beams_from_scan(scan, path, options, counts).size(), 1u);
  EXPECT_EQ(counts.skipped.at("no pose at its time"), 1u);

  scan.ring.pop_back();
  EXPECT_THROW(beams_from_scan(scan, path, options, counts), std::invalid_argument);
  PointScan none;
  EXPECT_TRUE(beams_from_scan(none, still, options, counts).empty());
}

TEST(BeamsFromScan, PerPointTimesAreKeptAndPacketsFollowThem) {
  const Sensor sensor = load("velodyne-hdl32e");
  const Trajectory still({{0, Pose{}}});
  const BeamLog log = beams(sensor, still, 3, 3.1);
  PointScan scan;
  for (size_t i = 0; i < log.size(); ++i) scan.point.push_back(10 * log.direction[i]);
  scan.intensity.assign(log.size(), 1);
  scan.time_s = log.time_s;
  scan.ring = log.ring;
  BeamOptions options;
  options.deskew = options.infer_misses = sensor;
  BeamCounts counts;
  const BeamLog back = beams_from_scan(scan, still, options, counts);
  EXPECT_EQ(counts.misses_inferred, 0u);
  EXPECT_EQ(back.time_s, log.time_s);
  EXPECT_EQ(back.packet, log.packet);
}

}  // namespace
}  // namespace underbrush::sensor
