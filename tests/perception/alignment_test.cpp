#include "underbrush/perception/alignment.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::perception {
namespace {

Pose turned(double yaw_rad, const Vec3& at) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())), at};
}

Rig two_sensors() {
  return {"two",
          {{"left", "ibeo-lux-2010", turned(0.5, {3, 1, 0.5}), 0.02, 0.004},
           {"right", "ibeo-lux-2010", turned(-0.5, {3, -1, 0.5}), 0.03, -0.002}}};
}

// A vehicle that drives a curve.
Trajectory curve() {
  std::vector<StampedPose> poses;
  for (int k = 0; k <= 20; ++k) {
    const double t = 0.01 * k;
    poses.push_back({t, turned(0.8 * t, {12 * t, 2 * t * t, 0.1 * t})});
  }
  return Trajectory(poses);
}

// What a sensor of the rig measures of fixed points, each at its own time.
SensorCloud scan(const Rig& rig, uint16_t sensor, const Trajectory& path,
                 const std::vector<Vec3>& world) {
  SensorCloud cloud;
  cloud.sensor = sensor;
  for (size_t i = 0; i < world.size(); ++i) {
    const double t = 0.02 + 0.001 * double(i);
    const Pose sensor_from_world =
        (*path.at(t) * rig.sensors[sensor].vehicle_from_sensor).inverse();
    cloud.point_m.push_back((sensor_from_world * world[i]).cast<float>());
    cloud.time_s.push_back(t + rig.sensors[sensor].clock_offset_s);
    cloud.intensity.push_back(float(i));
    cloud.ring.push_back(uint16_t(i));
  }
  return cloud;
}

std::vector<Vec3> landmarks() {
  Stream random(3);
  std::vector<Vec3> points;
  for (int k = 0; k < 100; ++k) {
    const double x = random.uniform(5, 40), y = random.uniform(-20, 20), z = random.uniform(0, 3);
    points.emplace_back(x, y, z);
  }
  return points;
}

TEST(Alignment, FixedPointsOfAllSensorsComeToRest) {
  const Rig rig = two_sensors();
  const Trajectory path = curve();
  const auto world = landmarks();
  const std::vector<SensorCloud> clouds{scan(rig, 0, path, world), scan(rig, 1, path, world)};
  Alignment alignment(rig);
  MergedCloud merged;
  alignment.merge(clouds, path, 0.1, merged);
  ASSERT_EQ(merged.size(), 2 * world.size());
  for (size_t i = 0; i < merged.size(); ++i) {
    const Vec3 p = merged.world_from_vehicle * merged.point_m[i].cast<double>();
    EXPECT_LT((p - world[merged.ring[i]]).norm(), 1e-4);
  }
  EXPECT_NEAR(merged.available_s, 0.02 + 0.099 + 0.03, 1e-9);
}

TEST(Alignment, PointsAreInOrderOfCorrectedTimeThenSensor) {
  const Rig rig = two_sensors();
  const Trajectory path = curve();
  const auto world = landmarks();
  std::vector<SensorCloud> clouds{scan(rig, 1, path, world), scan(rig, 0, path, world)};
  Alignment alignment(rig);
  MergedCloud merged, other;
  alignment.merge(clouds, path, 0.1, merged);
  for (size_t i = 0; i + 1 < merged.size(); ++i) {
    EXPECT_LE(merged.stamp_s[i], merged.stamp_s[i + 1] + 1e-12);
  }
  std::swap(clouds[0], clouds[1]);
  alignment.merge(clouds, path, 0.1, other);
  EXPECT_EQ(merged.sensor, other.sensor) << "the order of the clouds means nothing";
  EXPECT_EQ(merged.intensity, other.intensity);
}

TEST(Alignment, WithoutDeskewingPointsKeepTheirPlaceOnTheVehicle) {
  const Rig rig = two_sensors();
  const Trajectory path = curve();
  const SensorCloud cloud = scan(rig, 0, path, landmarks());
  MergedCloud merged;
  Alignment(rig, {.deskew = false}).merge({&cloud, 1}, path, 0.1, merged);
  for (size_t i = 0; i < merged.size(); ++i) {
    const Vec3 p = rig.sensors[0].vehicle_from_sensor * cloud.point_m[i].cast<double>();
    EXPECT_LT((merged.point_m[i].cast<double>() - p).norm(), 1e-5);
  }
}

TEST(Alignment, RefusesForeignSensorsAndTimesWithoutPose) {
  Alignment alignment(two_sensors());
  SensorCloud cloud = scan(two_sensors(), 0, curve(), landmarks());
  MergedCloud merged;
  cloud.sensor = 7;
  EXPECT_THROW(alignment.merge({&cloud, 1}, curve(), 0.1, merged), std::invalid_argument);
  cloud.sensor = 0;
  EXPECT_THROW(alignment.merge({&cloud, 1}, curve(), 9, merged), std::invalid_argument);
  cloud.time_s.pop_back();
  EXPECT_THROW(alignment.merge({&cloud, 1}, curve(), 0.1, merged), std::invalid_argument);
}

class RigFile : public testing::Test {
 protected:
  ~RigFile() override { std::filesystem::remove(path_); }
  Rig load(const std::string& text) {
    std::ofstream(path_) << text;
    return load_rig(path_.string());
  }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("rig_" + std::to_string(::getpid()) + ".yaml");
};

TEST_F(RigFile, ReadsPosesAndTimes) {
  const Rig rig = load(
      "name: one\nsensors:\n  - {name: a, sensor: ibeo-lux-2010, position_m: [1, 2, 3], "
      "rotation_deg: [0, 0, 90], latency_ms: 40, clock_offset_ms: -3}\n");
  ASSERT_EQ(rig.sensors.size(), 1u);
  EXPECT_LT((rig.sensors[0].vehicle_from_sensor * Vec3(1, 0, 0) - Vec3(1, 3, 3)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(rig.sensors[0].latency_s, 0.04);
  EXPECT_DOUBLE_EQ(rig.sensors[0].clock_offset_s, -0.003);
}

TEST_F(RigFile, NamesThePlaceOfAFault) {
  const auto reason = [&](const std::string& text) {
    try {
      load(text);
    } catch (const FormatError& e) {
      return e.place() + ": " + e.reason();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(reason("name: x\nsensors: []\n"), "sensors: expected a list of 1 to 255 sensors");
  for (const std::string& name : {std::string("nothing"), std::string(5000, 'a')}) {
    EXPECT_EQ(reason("name: x\nsensors:\n - {name: a, sensor: " + name + "}\n"),
              "sensors[0].sensor: no sensor of the catalogue, nor a file beside the rig's");
  }
  EXPECT_EQ(
      reason("name: x\nsensors:\n - {name: a, sensor: ibeo-lux-2010, position_m: [0, 0, 500]}\n"),
      "sensors[0].position_m: must be numbers of at most 100")
      << "mm";
  const std::string own = path_.filename().string();  // It is no sensor.
  EXPECT_EQ(reason("name: x\nsensors:\n - {name: a, sensor: " + own + "}\n")
                .find("sensors[0].sensor: " + path_.string() + ": "),
            0u);
  EXPECT_EQ(reason("name: x\nsensors:\n - {name: a, sensor: ibeo-lux-2010, colour: red}\n"),
            "sensors[0].colour: unknown key");
  EXPECT_EQ(reason("name: x\nsensors:\n - {name: a, sensor: ibeo-lux-2010, position_m: [1]}\n"),
            "sensors[0].position_m: needs three numbers");
}

}  // namespace
}  // namespace underbrush::perception
