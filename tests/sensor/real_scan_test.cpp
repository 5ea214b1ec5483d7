// Tests on recorded scans, with figures from the README files of the data folder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"
#include "underbrush/sensor/rings.hpp"

namespace underbrush::sensor {
namespace {

PointScan kitti_scan(const std::string& drive, uint32_t index) {
  const std::vector<float> values = test::kitti_frame(drive, index);
  PointScan scan;
  for (size_t i = 0; i + 3 < values.size(); i += 4) {
    scan.point.emplace_back(values[i], values[i + 1], values[i + 2]);
    scan.intensity.push_back(values[i + 3]);
  }
  scan.info.scan = index;
  return scan;
}

double share(size_t part, size_t rest) { return double(part) / double(part + rest); }

TEST(RealScan, KittiHas64RingsAndOneNumberOfBeams) {
  UNDERBRUSH_NEEDS_DATA("kitti_0027_forest");
  BeamOptions options;
  options.infer_misses = load("velodyne-hdl64e");
  options.revolution_s = 0.1036;
  options.elevation_offset_rad = 0.205 * M_PI / 180;
  for (const char* drive : {"kitti_0027_forest", "kitti_0005_city"}) {
    for (uint32_t frame : {0u, 11u, 22u}) {
      const PointScan scan = kitti_scan(drive, frame);
      ASSERT_GT(scan.size(), 100000u);
      EXPECT_EQ(rings_from_order(scan.point).back(), 63) << drive << " " << frame;
      BeamCounts counts;
      const BeamLog log = beams_from_scan(scan, Trajectory(), options, counts);
      EXPECT_EQ(counts.scans_ringed_by_elevation, 0u);
      EXPECT_EQ(counts.hits, scan.size());
      EXPECT_NEAR(double(counts.hits + counts.misses_inferred + counts.unknown), 137500, 400)
          << drive << " " << frame;
      size_t hits = 0, misses = 0;  // of the top 16 rings
      for (size_t i = 0; i < log.size(); ++i) {
        if (log.ring[i] < 16) ++(log.is_hit(i) ? hits : misses);
      }
      EXPECT_GT(share(misses, hits), 0.05) << drive << " " << frame;
      EXPECT_LT(share(misses, hits), 0.13) << drive << " " << frame;
      RecordProperty(std::string(drive) + std::to_string(frame), int(1000 * share(misses, hits)));
    }
  }
}

// The catalogue's table of the HDL-64E was measured on other frames. It tells the ring of a return
// from its elevation alone.
TEST(RealScan, KittiElevationsAreTheCatalogues) {
  UNDERBRUSH_NEEDS_DATA("kitti_0027_forest");
  const PointScan scan = kitti_scan("kitti_0027_forest", 33);
  const std::vector<uint16_t> by_order = rings_from_order(scan.point);
  const std::vector<uint16_t> by_elevation =
      rings_from_elevation(scan.point, load("velodyne-hdl64e"), 0.205 * M_PI / 180);
  size_t same = 0;
  for (size_t i = 0; i < scan.size(); ++i) same += by_order[i] == by_elevation[i];
  EXPECT_GT(double(same), 0.999 * double(scan.size())) << double(same) / double(scan.size());
}

TEST(RealScan, KittiDeskewedSpansTheDistanceDriven) {
  UNDERBRUSH_NEEDS_DATA("kitti_0027_forest");
  PointScan scan = kitti_scan("kitti_0027_forest", 5);
  std::vector<StampedPose> poses;
  for (int k = 0; k < 10; ++k) {
    poses.push_back({0.1036 * k, {Eigen::Quaterniond::Identity(), Vec3(1.9 * k, 0, 0)}});
  }
  scan.info.time_s = poses[5].time_s;
  BeamOptions options;
  options.deskew = load("velodyne-hdl64e");
  BeamCounts counts;
  const BeamLog log = beams_from_scan(scan, Trajectory(poses), options, counts);
  EXPECT_NEAR(log.time_s.front(), scan.info.time_s - 0.0518, 1e-4);
  EXPECT_NEAR(log.time_s.back(), scan.info.time_s + 0.0518, 1e-4);
  EXPECT_NEAR((log.origin.back() - log.origin.front()).norm(), 1.9, 0.01);
  EXPECT_NEAR(log.packet.back() + 1, 0.1036 / (6 * 48e-6), 1);
}

template <class T>
T at(const std::string& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(RealScan, RellisKeepsItsMisses) {
  UNDERBRUSH_NEEDS_DATA("rellis_000104");
  const std::string bytes = test::read_file(test::data_folder() / "rellis_000104/000104.bin");
  PointScan scan;
  for (size_t o = 0; o + 16 <= bytes.size(); o += 16) {
    scan.point.emplace_back(at<float>(bytes, o), at<float>(bytes, o + 4), at<float>(bytes, o + 8));
    scan.intensity.push_back(at<float>(bytes, o + 12));
  }
  BeamCounts counts;
  const BeamLog log = beams_from_scan(scan, Trajectory(), {}, counts);
  ASSERT_EQ(log.size(), 131072u);
  EXPECT_EQ(counts.misses_recorded, 53364u);
  EXPECT_TRUE(counts.skipped.empty());
  // Every third return is blanked, and its direction must be recovered from the rest of the grid.
  double worst = 0;
  PointScan thinned = scan;
  for (size_t i = 0; i < scan.size(); i += 3) thinned.point[i].setZero();
  const BeamLog guessed = beams_from_scan(thinned, Trajectory(), {}, counts);
  for (size_t i = 0; i < log.size(); ++i) {
    ASSERT_EQ(log.ring[i], i % 64);
    worst = std::max(worst, double((log.direction[i] - guessed.direction[i]).norm()));
  }
  EXPECT_LT(worst, 1e-4);
}

TEST(RealScan, MarvKeepsItsMisses) {
  UNDERBRUSH_NEEDS_DATA("marv_forest");
  const std::string npz =
      test::read_file(test::data_folder() / "marv_forest/1727353472_601360559.npz");
  // The archive is not compressed: after the zip's local header come the .npy header and records of
  // 24 bytes.
  const size_t npy = npz.find("\x93NUMPY");
  ASSERT_NE(npy, std::string::npos);
  const size_t data = npy + 10 + at<uint16_t>(npz, npy + 8), record = 24;
  PointScan scan;
  for (size_t o = data; scan.size() < 131072; o += record) {
    scan.point.emplace_back(at<float>(npz, o), at<float>(npz, o + 4), at<float>(npz, o + 8));
    scan.intensity.push_back(at<float>(npz, o + 12));
    scan.time_s.push_back(1e-9 * at<uint32_t>(npz, o + 16));
  }
  BeamCounts counts;
  const BeamLog log = beams_from_scan(scan, Trajectory(), {}, counts);
  ASSERT_EQ(log.size(), 131072u);
  EXPECT_EQ(counts.misses_recorded, 39172u);
  EXPECT_TRUE(counts.skipped.empty());
  EXPECT_EQ(log.ring.back(), 127);
  EXPECT_NEAR(std::asin(log.direction.back().z()) * 180 / M_PI, -46, 2);  // a ring without returns
  double worst = 0;
  PointScan thinned = scan;
  for (size_t i = 0; i < scan.size(); i += 3) thinned.point[i].setConstant(NAN);
  const BeamLog guessed = beams_from_scan(thinned, Trajectory(), {}, counts);
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.ring[i] < 108) {
      worst = std::max(worst, double((log.direction[i] - guessed.direction[i]).norm()));
    }
  }
  EXPECT_LT(worst, 5e-4);
}

}  // namespace
}  // namespace underbrush::sensor
