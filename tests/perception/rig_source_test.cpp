#include "underbrush/perception/rig_source.hpp"

#include <gtest/gtest.h>

#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/cycles.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::perception {
namespace {

Rig rig() {
  const auto mounted = [](const char* name, double y, double yaw) {
    return MountedSensor{
        name, "ibeo-lux-2010",
        Pose{Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), {3.7, y, 0.5}}, 0.04, 0};
  };
  return {"two", {mounted("left", 0.8, 0.4), mounted("right", -0.8, -0.4)}};
}

Trajectory straight() {
  return Trajectory({{10, {}}, {10.5, {Eigen::Quaterniond::Identity(), {5, 0, 0}}}});
}

TEST(RigSource, HasEveryBeamOfEverySensorInOrderOfTime) {
  const Trajectory path = straight();
  RigSource source(rig(), path, 1000);
  BeamLog all, chunk;
  while (source.next(chunk)) {
    if (all.empty()) {
      all = chunk;
    } else {
      all.append(chunk, 0, chunk.size());
    }
  }
  ASSERT_EQ(all.size(), source.size());
  const auto& sensor = std::get<std::vector<uint8_t>>(all.extra.at(kSensorColumn));
  for (size_t i = 1; i < all.size(); ++i) ASSERT_LE(all.time_s[i - 1], all.time_s[i]);
  for (uint8_t k = 0; k < 2; ++k) {
    std::vector<StampedPose> poses = path.poses();
    for (auto& p : poses) {
      p.world_from_sensor = p.world_from_sensor * rig().sensors[k].vehicle_from_sensor;
    }
    const Trajectory own(poses);
    const BeamLog alone = sensor::beams(sensor::load("ibeo-lux-2010"), own, 10, 10.5);
    size_t at = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (sensor[i] != k) continue;
      ASSERT_EQ(all.origin[i], alone.origin[at]);
      ASSERT_EQ(all.direction[i], alone.direction[at]);
      ASSERT_EQ(all.time_s[i], alone.time_s[at]);
      ++at;
    }
    EXPECT_EQ(at, alone.size());
  }
  EXPECT_EQ(all.info.scans.size(), 7u) << "0.5 s at 12.5 Hz";
  EXPECT_EQ(all.info.scans[3].world_from_sensor.translation, path.at(10.24)->translation);
}

TEST(RigSource, ChunksDoNotChangeTheBeams) {
  const Trajectory path = straight();
  RigSource small(rig(), path, 77), large(rig(), path, 1 << 20);
  BeamLog whole, chunk;
  ASSERT_TRUE(large.next(whole));
  size_t at = 0;
  while (small.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i, ++at) {
      ASSERT_EQ(chunk.time_s[i], whole.time_s[at]);
      ASSERT_EQ(chunk.scan[i], whole.scan[at]);
      ASSERT_EQ(chunk.packet[i], whole.packet[at]);
    }
  }
  EXPECT_EQ(at, whole.size());
}

// A log of a plane wall ahead: all sensors and cycles agree on where it is.
BeamLog wall() {
  const Trajectory path = straight();
  RigSource source(rig(), path, 1 << 20);
  BeamLog log;
  source.next(log);
  for (size_t i = 0; i < log.size(); ++i) {
    const double along = double(log.direction[i].x());
    if (along > 0.2) log.range_m[i] = float((30 - log.origin[i].x()) / along);
  }
  return log;
}

TEST(CycleReader, GivesACloudForEachCycleInTheVehiclesFrame) {
  const BeamLog log = wall();
  MemorySource source(log, 500);
  CycleReader reader(source, rig());
  MergedCloud cloud;
  size_t cycles = 0, hits = 0;
  for (; reader.next(cloud); ++cycles) {
    EXPECT_EQ(reader.scan(), cycles);
    hits += cloud.size();
    ASSERT_EQ(cloud.sensor_m.size(), 2u);
    for (const Vec3f& p : cloud.point_m) {
      EXPECT_NEAR((cloud.world_from_vehicle * p.cast<double>()).x(), 30, 2e-3);
    }
  }
  EXPECT_EQ(cycles, 7u);
  size_t expected = 0;
  for (size_t i = 0; i < log.size(); ++i) expected += log.is_hit(i);
  EXPECT_EQ(hits, expected);
  EXPECT_NEAR(reader.cycle_s(), 0.08, 1e-9);
}

TEST(CycleReader, WithoutDeskewingTheWallIsSmeared) {
  const BeamLog log = wall();
  MemorySource source(log);
  CycleOptions options;
  options.alignment.deskew = false;
  CycleReader reader(source, rig(), options);
  MergedCloud cloud;
  double worst = 0, latest = 0;
  while (reader.next(cloud)) {
    for (size_t i = 0; i < cloud.size(); ++i) {
      const Vec3 p = cloud.world_from_vehicle * cloud.point_m[i].cast<double>();
      worst = std::max(worst, std::abs(p.x() - 30));
      latest = std::max(latest, cloud.stamp_s[i] - cloud.time_s);
    }
  }
  EXPECT_GT(latest, 0.01);
  EXPECT_NEAR(worst, 10 * latest, 0.01) << "the vehicle drives at 10 m/s";
}

TEST(CycleReader, ALogWithoutPosesStandsWhereItsBeamsBegin) {
  BeamLog log = wall();
  log.extra.clear();
  log.info.scans.clear();
  MemorySource source(log);
  CycleReader reader(source, std::nullopt);
  MergedCloud cloud;
  size_t cycles = 0;
  for (; reader.next(cloud); ++cycles) {
    EXPECT_LT((cloud.world_from_vehicle.translation - log.origin[0]).norm(), 6);
    for (const Vec3f& p : cloud.point_m) {
      EXPECT_NEAR((cloud.world_from_vehicle * p.cast<double>()).x(), 30, 2e-3);
    }
  }
  EXPECT_EQ(cycles, 7u);
}

TEST(CycleReader, RefusesALogOfSeveralSensorsWithoutTheirRig) {
  const BeamLog log = wall();
  MemorySource source(log);
  CycleReader reader(source, std::nullopt);
  MergedCloud cloud;
  EXPECT_THROW(reader.next(cloud), DataError);
}

}  // namespace
}  // namespace underbrush::perception
