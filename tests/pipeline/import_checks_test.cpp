#include "underbrush/pipeline/import_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/pipeline/copies.hpp"
#include "underbrush/pipeline/pose_checks.hpp"
#include "underbrush/pipeline/sensor_checks.hpp"

namespace underbrush::pipeline {
namespace {

/// A scan of a sensor in a round room of that radius.
PointScan scan_of(const sensor::Sensor& sensor, double radius_m = 20) {
  PointScan scan;
  for (int k = 0; k < 60; ++k) {
    for (const sensor::Channel& c : sensor.channels) {
      const double azimuth = 2 * M_PI * k / 60, range = radius_m + k % 3;
      scan.point.push_back(Vec3f(float(range * std::cos(c.elevation_rad) * std::cos(azimuth)),
                                 float(range * std::cos(c.elevation_rad) * std::sin(azimuth)),
                                 float(range * std::sin(c.elevation_rad) + c.z_m)));
    }
  }
  return scan;
}

TEST(ImportChecks, ASensorFitsItsOwnScansAlone) {
  const std::vector<std::string> names{"velodyne-vlp16", "velodyne-hdl32e", "velodyne-hdl64e",
                                       "ouster-os0-128"};
  for (const std::string& own : names) {
    const PointScan scan = scan_of(sensor::load(own));
    EXPECT_NO_THROW(check_sensor_of("f", "--deskew", scan, sensor::load(own)));
  }
  const auto refused = [](const char* data, const char* named) {
    EXPECT_THROW(check_sensor_of("f", "--deskew", scan_of(sensor::load(data)), sensor::load(named)),
                 FormatError)
        << data << " as " << named;
  };
  refused("velodyne-hdl64e", "velodyne-vlp16");
  refused("velodyne-hdl64e", "ouster-os1-64");
  refused("ouster-os0-128", "velodyne-vlp16");
  refused("ouster-os0-128", "velodyne-hdl64e");
  refused("velodyne-hdl32e", "velodyne-hdl64e");
  PointScan ringed = scan_of(sensor::load("velodyne-vlp16"));
  ringed.ring.assign(ringed.size(), 31);
  EXPECT_THROW(check_sensor_of("f", "--deskew", ringed, sensor::load("velodyne-vlp16")),
               FormatError);
  EXPECT_THROW(check_sensor_of("f", "--deskew", scan_of(sensor::load("velodyne-vlp16"), 5000),
                               sensor::load("velodyne-vlp16")),
               FormatError);
}

bool has_channels(const PointScan& scan, const sensor::Sensor& sensor) {
  try {
    check_channels_of("f", "--infer-misses", scan, sensor, 0);
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find("have no return"), std::string::npos) << e.what();
    return false;
  }
  return true;
}

PointScan without(PointScan scan, const std::function<bool(size_t)>& dropped) {
  PointScan out;
  for (size_t i = 0; i < scan.size(); ++i) {
    if (dropped(i)) continue;
    out.point.push_back(scan.point[i]);
    if (!scan.ring.empty()) out.ring.push_back(scan.ring[i]);
  }
  return out;
}

TEST(ImportChecks, MissesNeedAllChannelsOfTheSensor) {
  for (const char* name : {"velodyne-vlp16", "velodyne-hdl32e", "velodyne-hdl64e",
                           "velodyne-vlp32c", "velodyne-vls128", "hesai-xt32", "hesai-pandar64",
                           "ouster-os0-128", "ouster-os1-64", "ouster-os1-128", "ouster-os2-128"}) {
    SCOPED_TRACE(name);
    const sensor::Sensor own = sensor::load(name);
    const size_t n = own.channels.size();
    const PointScan scan = scan_of(own);
    EXPECT_TRUE(has_channels(scan, own));
    Stream random(5);
    const auto thinned = [&](size_t) { return random.uniform() < 0.7; };
    EXPECT_TRUE(has_channels(without(scan, thinned), own));
    // A third sees only sky, two channels are dead.
    const auto third = [&](size_t i) { return own.channels[i % n].elevation_rad > 0.05; };
    EXPECT_TRUE(has_channels(without(scan, third), own));
    const auto dead = [&](size_t i) { return i % n == 3 || i % n == 9; };
    EXPECT_TRUE(has_channels(without(scan, dead), own));
    // Half of the rings were left out, which their own numbers tell.
    PointScan ringed = scan;
    for (size_t i = 0; i < scan.size(); ++i) ringed.ring.push_back(uint16_t(i % n));
    const auto half = [&](size_t i) { return i % n % 2 == 1; };
    EXPECT_TRUE(has_channels(without(ringed, half), own));
    EXPECT_FALSE(has_channels(without(scan, half), own));
  }
  const PointScan vlp16 = scan_of(sensor::load("velodyne-vlp16"));
  PointScan ringed = vlp16;
  for (size_t i = 0; i < vlp16.size(); ++i) ringed.ring.push_back(uint16_t(i % 16));
  for (const char* name :
       {"hesai-xt32", "velodyne-hdl32e", "velodyne-vlp32c", "hesai-pandar64", "ouster-os1-64"}) {
    EXPECT_FALSE(has_channels(vlp16, sensor::load(name))) << name;
    EXPECT_FALSE(has_channels(ringed, sensor::load(name))) << name;
  }
}

TEST(ImportChecks, PointsAtTheGreatestRangeAreWarnedOf) {
  PointScan scan = scan_of(sensor::load("velodyne-vlp16"));
  for (size_t i = 0; i < scan.size(); ++i) scan.point[i] *= 1 + 1e-3F * float(i % 97);
  EXPECT_EQ(warning_of_greatest_range(scan, 0), "");
  for (size_t i = 0; i < scan.size(); i += 20) scan.point[i] *= 120 / scan.point[i].norm();
  EXPECT_NE(warning_of_greatest_range(scan, 0).find("--max-range 120 makes them misses"),
            std::string::npos);
  EXPECT_EQ(warning_of_greatest_range(scan, 120), "");
}

std::vector<ScanInfo> drive(const Vec3& velocity, const Eigen::Quaterniond& rotation) {
  std::vector<ScanInfo> scans;
  for (uint32_t k = 0; k < 20; ++k) {
    scans.push_back({k, 0.1 * k, {rotation, 0.1 * k * velocity}});
  }
  return scans;
}

TEST(ImportChecks, PosesAreWarnedOfByTheirMotionAndTheirUpright) {
  const Eigen::Quaterniond level(Eigen::AngleAxisd(0.4, Vec3::UnitZ()));
  const auto warned = [](const std::vector<ScanInfo>& scans, const char* word) {
    const std::vector<std::string> found = warnings_of_poses(scans);
    return found.size() == 1 && found[0].find(word) != std::string::npos;
  };
  EXPECT_TRUE(warnings_of_poses(drive({8, 1, 0.2}, level)).empty());
  EXPECT_TRUE(warnings_of_poses(drive({0, 0, 0}, level)).empty());
  EXPECT_TRUE(warned(drive({8000, 0, 0}, level), "mm"));
  EXPECT_TRUE(warned(drive({0.1, 0, 8}, level), "camera"));
  const Eigen::Quaterniond on_its_side(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()));
  EXPECT_TRUE(warnings_of_poses(drive({8, 0, 0}, on_its_side)).empty()) << "as mounted";
}

TEST(ImportChecks, MillimetresAreWarnedOf) {
  EXPECT_EQ(warning_of_ranges(scan_of(sensor::load("velodyne-vlp16"))), "");
  EXPECT_NE(warning_of_ranges(scan_of(sensor::load("velodyne-vlp16"), 20000)).find("--unit mm"),
            std::string::npos);
  EXPECT_NE(warning_of_ranges(scan_of(sensor::load("velodyne-vlp16"), 1500)).find("--unit cm"),
            std::string::npos);
  PointScan whole = scan_of(sensor::load("velodyne-vlp16"), 300);
  EXPECT_EQ(warning_of_ranges(whole), "");
  for (Vec3f& p : whole.point) p = p.array().floor();
  EXPECT_NE(warning_of_ranges(whole), "") << "cm, and all near";
  PointScan below;
  for (int k = 0; k < 200; ++k) below.point.emplace_back(float(k), 0.F, -800.F);
  EXPECT_EQ(warning_of_ranges(below), "") << "from an aircraft";
}

TEST(ImportChecks, TimesThatTellNoMotionAreFound) {
  PointScan scan = scan_of(sensor::load("velodyne-vlp16"));
  EXPECT_EQ(coarse_times(scan), 0u) << "there are none";
  scan.time_s.assign(scan.size(), 0);
  EXPECT_EQ(coarse_times(scan), 1u);
  for (size_t i = 0; i < scan.size(); ++i) scan.time_s[i] = float(1.6e9 + 1e-4 * double(i));
  EXPECT_EQ(coarse_times(scan), 1u) << "steps of 128 s";
  for (size_t i = 0; i < scan.size(); ++i) scan.time_s[i] = 1e-4 * double(i / 16);
  EXPECT_EQ(coarse_times(scan), 0u);
}

TEST(ImportChecks, TimesThatRunAgainstTheRotation) {
  PointScan scan = scan_of(sensor::load("velodyne-vlp16"));  // counter-clockwise
  for (size_t i = 0; i < scan.size(); ++i) scan.time_s.push_back(50 + 1e-4 * double(i));
  EXPECT_EQ(warning_of_turn(scan, 1), "");
  EXPECT_NE(warning_of_turn(scan, -1).find("--point-times before"), std::string::npos);
  for (double& t : scan.time_s) t = -t;
  EXPECT_EQ(warning_of_turn(scan, -1), "");
  EXPECT_NE(warning_of_turn(scan, 1), "");
  std::mt19937 draw(5);
  for (double& t : scan.time_s) t = double(draw());
  for (const double turn : {1.0, -1.0}) EXPECT_EQ(warning_of_turn(scan, turn), "");
  scan.time_s.clear();
  EXPECT_EQ(warning_of_turn(scan, 1), "");
}

TEST(Copies, OneOfEachStays) {
  PointScan scan;
  for (int k = 0; k < 100; ++k) {  // The last return of every tenth pulse is another one.
    for (const bool last : {false, true}) {
      scan.point.push_back(Vec3f(5.f + float(k), 1, last && k % 10 == 0 ? 2.f : 1.f));
      scan.time_s.push_back(1e-3 * k);
      scan.intensity.push_back(float(k));
      scan.ring.push_back(uint16_t(k % 16));
    }
  }
  EXPECT_NEAR(share_of_copies(scan), 0.45, 1e-12);
  PointScan others = scan;
  EXPECT_EQ(remove_copies(scan), 90u);
  EXPECT_EQ(scan.size(), 110u);
  EXPECT_EQ(scan.intensity[2], 1);
  others.time_s.clear();
  EXPECT_EQ(share_of_copies(others), 0) << "nothing tells a pulse";
}

/// Rings on flat ground, which are the same from every place.
class OpenGround : public ScanSource {
 public:
  explicit OpenGround(
      const Eigen::Quaterniond& sensor_from_upright = Eigen::Quaterniond::Identity())
      : turn_(sensor_from_upright) {}
  size_t size() const override { return 3; }
  PointScan read(size_t) override {
    PointScan scan;
    for (int ring = 0; ring < 8; ++ring) {
      for (int k = 0; k < 180; ++k) {
        const double a = 2 * M_PI * k / 180, r = 4 + 3 * ring;
        scan.point.push_back((turn_ * Vec3(r * std::cos(a), r * std::sin(a), -1.8)).cast<float>());
      }
    }
    return scan;
  }
  const Trajectory& trajectory() const override { return path_; }
  const std::map<std::string, size_t>& skipped() const override { return skipped_; }

 private:
  Eigen::Quaterniond turn_;
  Trajectory path_;
  std::map<std::string, size_t> skipped_;
};

TEST(ImportChecks, GroundThatThePosesTiltIsWarnedOf) {
  const auto about = [](double degrees, const Vec3& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180, axis));
  };
  const auto warned = [](const Eigen::Quaterniond& mounted, const Eigen::Quaterniond& pose) {
    OpenGround ground(mounted.inverse());
    std::vector<ScanInfo> scans;
    for (uint32_t k = 0; k < 3; ++k) scans.push_back({k, 0.1 * k, {pose, {0.6 * k, 0, 0}}});
    const std::string all = warning_of_scans(ground, scans);
    scans.resize(1);
    EXPECT_EQ(warning_of_scans(ground, scans), all);
    return all.empty()                                            ? 0
           : all.find("the ground is steep") != std::string::npos ? 1
           : all.find("qw qx qy qz") != std::string::npos         ? 2
           : all.find("upside down") != std::string::npos         ? 3
                                                                  : 4;
  };
  const Eigen::Quaterniond upright = about(30, Vec3::UnitZ());
  EXPECT_EQ(warned(upright, about(90, Vec3::UnitX()) * upright), 1) << "of a camera";
  EXPECT_EQ(warned(upright, about(45, Vec3::UnitY())), 1);
  EXPECT_EQ(warned(upright, about(180, Vec3::UnitX())), 2);
  EXPECT_EQ(warned(about(180, Vec3::UnitX()) * upright, upright), 3);
  EXPECT_EQ(warned(upright, upright), 0);
  EXPECT_EQ(warned(upright, about(35, Vec3::UnitY())), 0) << "a steep slope";
  for (const double degrees : {45, 90, 180}) {
    const Eigen::Quaterniond tilted = about(degrees, Vec3::UnitY()) * upright;
    EXPECT_EQ(warned(tilted, tilted), 0) << degrees << ": as mounted";
  }
}

TEST(ImportChecks, OpenGroundShowsNoMotion) {
  OpenGround ground;
  const auto warned = [&](double step_m) {
    std::vector<ScanInfo> scans;
    for (uint32_t k = 0; k < 3; ++k) scans.push_back({k, 0.1 * k, {}});
    for (uint32_t k = 0; k < 3; ++k) scans[k].world_from_sensor.translation.x() = step_m * k;
    return warning_of_scans(ground, scans);
  };
  EXPECT_EQ(warned(0.6), "");
  EXPECT_EQ(warned(50), "");
}

}  // namespace
}  // namespace underbrush::pipeline
