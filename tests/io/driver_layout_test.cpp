#include "underbrush/io/driver_layout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace {

/// Gives the pose of a sensor that drives along x at 10 m/s and turns. It measures two scans of 2
/// rings × 3 firings; every point lies 5 m ahead of the sensor and 1 m up at its firing.
Pose pose_at(double t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(2 * t, Vec3::UnitZ())), Vec3(100 + 10 * t, 3, 2)};
}

BeamLog drive() {
  BeamLog log;
  log.info.deskewed = log.info.has_misses = true;
  log.resize(12);
  const Vec3 ahead(5, 0, 1);
  for (size_t i = 0; i < 12; ++i) {
    const double t = 0.05 * double(i / 2);
    const Pose pose = pose_at(t);
    log.origin[i] = pose.translation;
    log.direction[i] = (pose.rotation * ahead).normalized().cast<float>();
    log.range_m[i] = float(ahead.norm());
    log.intensity[i] = float(20 * i);
    log.time_s[i] = 7 + t;
    log.ring[i] = uint16_t(i % 2);
    log.scan[i] = uint32_t(i / 6);
  }
  log.range_m[3] = kMiss;
  log.intensity[3] = 0;
  log.info.scans = {{0, 7, pose_at(0)}, {1, 7.15, pose_at(0.15)}};
  return log;
}

Trajectory path() { return Trajectory({{7, pose_at(0)}, {7.3, pose_at(0.3)}}); }

Table written(const TemporaryFolder& folder, const BeamLog& log, DriverLayout profile,
              const char* file) {
  MemorySource source(log, 5);
  export_driver_layout(folder / "out", source, profile, path(), "{}");
  return read_pcd(folder / "out" / file);
}

std::vector<double> values(const Table& t, const char* name) {
  const ExtraColumn* c = t.find({name});
  return c ? doubles_of(*c) : std::vector<double>();
}

std::vector<std::string> fields(const Table& t) {
  std::vector<std::string> names;
  for (const auto& [name, column] : t.columns) names.push_back(name);
  return names;
}

TEST(DriverLayout, VelodynePointsAreRawInTheSensorsFrame) {
  const TemporaryFolder folder;
  const Table t = written(folder, drive(), DriverLayout::kVelodyne, "000000.pcd");
  EXPECT_EQ(fields(t), (std::vector<std::string>{"x", "y", "z", "intensity", "ring", "time"}));
  ASSERT_EQ(t.size(), 5u);  // the miss is left out
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(values(t, "x")[i], 5, 1e-5) << i;  // a motion-compensated scan would be 0.5 m off
    EXPECT_NEAR(values(t, "y")[i], 0, 1e-5) << i;
    EXPECT_NEAR(values(t, "z")[i], 1, 1e-5) << i;
  }
  EXPECT_EQ(values(t, "ring"), (std::vector<double>{0, 1, 0, 0, 1}));
  EXPECT_NEAR(values(t, "time")[4], 0.1, 1e-7);
  EXPECT_TRUE(std::holds_alternative<std::vector<uint16_t>>(*t.find({"ring"})));
  EXPECT_EQ(read_times(folder / "out/times.txt"), (std::vector<double>{7, 7.15}));
  EXPECT_NEAR(read_poses(folder / "out/poses.txt").pose[1].translation.x(), 101.5, 1e-12);
}

TEST(DriverLayout, OusterCloudsAreOrganisedAndKeepMissesAsZeros) {
  const TemporaryFolder folder;
  const Table t = written(folder, drive(), DriverLayout::kOuster, "000000.pcd");
  EXPECT_EQ(fields(t), (std::vector<std::string>{"x", "y", "z", "intensity", "t", "reflectivity",
                                                 "ring", "ambient", "range"}));
  EXPECT_EQ(values(t, "ring"), (std::vector<double>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(values(t, "t"), (std::vector<double>{0, 5e7, 1e8, 0, 5e7, 1e8}));
  EXPECT_EQ(values(t, "range"), (std::vector<double>{5099, 5099, 5099, 5099, 0, 5099}));
  EXPECT_EQ(values(t, "x")[4], 0);
  EXPECT_NE(bytes_of(folder / "out/000000.pcd").find("WIDTH 3\nHEIGHT 2\n"), std::string::npos);
}

TEST(DriverLayout, AutowareHasPolarCoordinatesAndReturnTypes) {
  BeamLog log = drive();
  log.extra[kEchoColumn] = std::vector<uint8_t>{1, 2, 1, 0, 1, 2, 1, 2, 3, 1, 1, 1};
  log.extra[kEchoesColumn] = std::vector<uint8_t>{2, 2, 1, 0, 2, 2, 3, 3, 3, 1, 1, 1};
  log.intensity[4] = 300;
  const TemporaryFolder folder;
  const Table t = written(folder, log, DriverLayout::kAutoware, "000000.pcd");
  EXPECT_EQ(fields(t),
            (std::vector<std::string>{"x", "y", "z", "intensity", "return_type", "channel",
                                      "azimuth", "elevation", "distance", "time_stamp"}));
  EXPECT_EQ(values(t, "return_type"), (std::vector<double>{5, 4, 1, 3, 6}));
  EXPECT_EQ(values(t, "intensity"), (std::vector<double>{0, 20, 40, 255, 100}));
  EXPECT_NEAR(values(t, "elevation")[0], std::atan2(1, 5), 1e-6);
  EXPECT_NEAR(values(t, "azimuth")[2], 0, 1e-6);
  EXPECT_NEAR(values(t, "distance")[2], std::sqrt(26), 1e-5);
  EXPECT_EQ(values(t, "time_stamp")[2], 5e7);
  EXPECT_EQ(values(read_pcd(folder / "out/000001.pcd"), "return_type"),
            (std::vector<double>{5, 0, 4, 1, 1, 1}));
}

TEST(DriverLayout, OthersFoldersAndScansInPiecesAreRefused) {
  const TemporaryFolder folder;
  put_bytes(folder / "out/precious.txt", "mine");
  BeamLog log = drive();
  MemorySource source(log);
  EXPECT_THROW(export_driver_layout(folder / "out", source, DriverLayout::kOuster, path(), ""),
               IoError);
  log.scan[11] = 0;
  EXPECT_THROW(export_driver_layout(folder / "new", source, DriverLayout::kOuster, path(), ""),
               std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "new"));
}

TEST(Echoes, AreKeptByPlyPcdAndCsvAndOneRowABeamIsRead) {
  BeamLog log = drive();
  log.extra[kEchoColumn] = std::vector<uint8_t>{1, 2, 1, 0, 1, 2, 1, 2, 3, 1, 1, 1};
  log.extra[kEchoesColumn] = std::vector<uint8_t>{2, 2, 1, 0, 2, 2, 3, 3, 3, 1, 1, 1};
  log.extra[kPulseWidthColumn] = std::vector<float>(12, 0.75F);
  const TemporaryFolder folder;
  for (const char* name : {"log.ply", "log.pcd", "log.csv"}) export_log(folder / name, log);
  const BeamLog back = read_log(folder / "log.ply");
  EXPECT_EQ(back.extra, log.extra);
  BeamReader reader(folder / "log.ply", 4);
  EXPECT_EQ(reader.size(), 8u);
  size_t beams = 0;
  for (BeamLog chunk; reader.next(chunk);) beams += chunk.size();
  EXPECT_EQ(beams, 8u);
  const Table pcd = read_pcd(folder / "log.pcd"), csv = read_csv(folder / "log.csv");
  EXPECT_EQ(values(pcd, "echo"), (std::vector<double>{1, 2, 1, 1, 2, 1, 2, 3, 1, 1, 1}));
  EXPECT_EQ(values(pcd, "pulse_width"), std::vector<double>(11, 0.75));
  EXPECT_EQ(values(csv, "echoes")[6], 3);
  EXPECT_EQ(values(csv, "pulse_width")[0], 0.75);
}

}  // namespace
}  // namespace underbrush::io
