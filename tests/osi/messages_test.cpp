#include "messages.hpp"

#include <gmock/gmock.h>

#include "data.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush {
namespace {

template <class Message>
std::string bytes_of(const Message& m) {
  std::string out;
  osi::write(m, out);
  return out;
}

// A GroundTruth becomes the view that carries it, with what is not kept here, such as lanes.
TEST(Messages, TruthAsAView) {
  osi::GroundTruth truth = test::truth();
  truth.host_vehicle_id = 0;
  std::string bytes = bytes_of(truth);
  bytes += std::string("\x52\x03\x0a\x01\x08", 5);  // A lane (field 10).
  const osi::SensorView v = osi::view_of_ground_truth(bytes, "t");
  ASSERT_TRUE(v.truth);
  EXPECT_EQ(v.truth->lanes, truth.lanes + 1);
  EXPECT_EQ(v.truth->moving.size(), truth.moving.size());
  EXPECT_EQ(v.timestamp, truth.timestamp);
  EXPECT_EQ(v.host_vehicle_id, 0u);
  ASSERT_TRUE(v.host());
  EXPECT_NE(v.bytes.find(bytes), std::string::npos);
  EXPECT_THROW(osi::view_of_ground_truth(bytes.substr(0, bytes.size() - 1), "t"), FormatError);
}

// The usual layout of reflections is read without the steps of the others.
TEST(Messages, ReflectionsOfAllLayouts) {
  osi::SensorView v;
  osi::LidarSensorView& l = v.lidar.emplace_back();
  for (const uint64_t id :
       {uint64_t(0), uint64_t(1), uint64_t(127), uint64_t(128), uint64_t(1) << 14,
        (uint64_t(1) << 35) - 1, uint64_t(1) << 35, UINT64_MAX - 1, osi::kNoId}) {
    for (const bool has_doppler : {false, true}) {
      l.reflections.push_back(
          {-31.5, 1e-7, has_doppler ? 5.0 : 0.0, id, Vec3f::Zero(), has_doppler});
    }
  }
  const osi::SensorView back = osi::read_sensor_view(bytes_of(v), "v");
  ASSERT_EQ(back.lidar[0].reflections.size(), l.reflections.size());
  for (size_t k = 0; k < l.reflections.size(); ++k) {
    const osi::Reflection &a = back.lidar[0].reflections[k], &b = l.reflections[k];
    EXPECT_EQ(a.object_id, b.object_id);
    EXPECT_EQ(a.signal_db, b.signal_db);
    EXPECT_EQ(a.time_of_flight_s, b.time_of_flight_s);
    EXPECT_EQ(a.has_doppler, b.has_doppler);
  }
  EXPECT_EQ(bytes_of(back), bytes_of(v));
}

// An identifier that is cut off or goes on is refused, as in any other message.
TEST(Messages, ReflectionsWithDamagedIdentifiers) {
  osi::SensorView v;
  v.lidar.emplace_back().reflections.push_back({-31.5, 1e-7, 0, 300, Vec3f::Zero(), false});
  const std::string good = bytes_of(v);
  ASSERT_EQ(uint8_t(good.back()), 2);  // 300 = 2 · 128 + 44
  for (const char last : {char(0x82), char(0xFF)}) {
    std::string bad = good;
    bad.back() = last;
    EXPECT_THROW(osi::read_sensor_view(bad, "v"), FormatError);
  }
  std::string other = good;
  other[other.size() - 2] = 44;  // A second number follows the first: an unknown field, cut off.
  EXPECT_THROW(osi::read_sensor_view(other, "v"), FormatError);
}

TEST(Messages, ViewSurvivesARoundTrip) {
  const std::string bytes = bytes_of(test::view());
  const osi::SensorView v = osi::read_sensor_view(bytes, "v");
  EXPECT_EQ(bytes_of(v), bytes);
  EXPECT_EQ(v.bytes, bytes);
  ASSERT_TRUE(v.host());
  EXPECT_EQ(v.host()->id, 0u);
  EXPECT_EQ(v.host()->model_reference, "car.glb");
  EXPECT_EQ(*v.timestamp, (osi::Timestamp{12, 500'000'000}));
  ASSERT_EQ(v.lidar.size(), 1u);
  ASSERT_EQ(v.lidar[0].reflections.size(), 3u);
  EXPECT_EQ(v.lidar[0].reflections[0].object_id, 7u);
  EXPECT_TRUE(v.lidar[0].reflections[1].is_miss());
  EXPECT_EQ(v.lidar[0].reflections[2].object_id, osi::kNoId);
  EXPECT_EQ(v.lidar[0].reflections[2].doppler_shift_hz, 100);
  EXPECT_EQ(v.lidar[0].configuration->timings_us, (std::vector<uint32_t>{0, 300, 70000}));
  EXPECT_EQ(v.truth->stationary[0].model_reference, "house");
}

TEST(Messages, DirectionsSurviveToTheBit) {
  // The norm of a unit vector in single precision is not exactly 1.
  osi::SensorView v = test::view();
  auto& directions = v.lidar[0].configuration->directions;
  Stream random(1);
  directions.clear();
  for (int k = 0; k < 1000; ++k) {
    Vec3 d;
    for (int i = 0; i < 3; ++i) d[i] = random.normal();
    directions.push_back(d.normalized().cast<float>());
  }
  EXPECT_EQ(osi::read_sensor_view(bytes_of(v), "v").lidar[0].configuration->directions, directions);
  directions[0] *= 3;  // Other simulators may send vectors of any length.
  const auto read = osi::read_sensor_view(bytes_of(v), "v").lidar[0].configuration->directions;
  EXPECT_NEAR(double(read[0].norm()), 1, 1e-6);
}

TEST(Messages, DataSurviveARoundTrip) {
  osi::SensorData d = test::data();
  auto seen = std::make_shared<osi::SensorView>(test::view());
  d.views = {seen};
  const std::string bytes = bytes_of(d);
  const osi::SensorData back = osi::read_sensor_data(bytes, "d");
  EXPECT_EQ(bytes_of(back), bytes);
  ASSERT_EQ(back.objects.size(), 1u);
  EXPECT_EQ(back.objects[0].ground_truth_ids, std::vector<uint64_t>{7});
  EXPECT_EQ(back.objects[0].candidates[1].probability, 0.25);
  EXPECT_EQ(back.lidar[0].detections[0].beam_id, 0u);
  EXPECT_EQ(*back.lidar[0].detections[0].radial_velocity_m_s, -3.0);
  EXPECT_EQ(back.logical->detections[0].position_m, Vec3(15, 2, 0.5));
  EXPECT_EQ(back.views[0]->bytes, bytes_of(*seen));
}

TEST(Messages, ConfigurationSurvivesARoundTrip) {
  osi::SensorViewConfiguration c;
  c.version = osi::Version{};
  c.sensor_id = 4;
  c.mounting = osi::Mounting{Vec3(1, 2, 3), Vec3::Zero()};
  c.range_m = 120;
  c.cycle_s = 0.08;
  c.lidar = {*test::view().lidar[0].configuration};
  const std::string bytes = bytes_of(c);
  EXPECT_EQ(bytes_of(osi::read_configuration(bytes, "c")), bytes);
}

TEST(Messages, UnknownFieldsOfDataAreKept) {
  const std::string lanes("\xBA\x01\x02\x0A\x00", 5);  // Field 23, a lane with an empty header.
  const osi::SensorData d = osi::read_sensor_data(bytes_of(test::data()) + lanes, "d");
  EXPECT_EQ(d.other, lanes);
  EXPECT_EQ(bytes_of(d), bytes_of(test::data()) + lanes);
}

TEST(Messages, EveryTruncationIsAFormatErrorOrAShorterMessage) {
  const std::string bytes = bytes_of(test::data()), view = bytes_of(test::view());
  size_t errors = 0;
  for (size_t n = 0; n < bytes.size(); ++n) {
    try {
      osi::read_sensor_data(bytes.substr(0, n), "d");
    } catch (const FormatError&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, bytes.size() / 2);
  for (size_t n = 0; n < view.size(); ++n) {
    try {
      osi::read_sensor_view(view.substr(0, n), "v");
    } catch (const FormatError&) {
      ++errors;
    }
  }
}

std::string reason_of(const osi::SensorView& view) {
  try {
    osi::read_sensor_view(bytes_of(view), "in.osi: message 3");
  } catch (const FormatError& e) {
    return e.what();
  }
  return "";
}

TEST(Messages, AbsurdValuesAreNamed) {
  osi::SensorView v = test::view();
  v.truth->moving[1].base.position_m->y() = NAN;
  EXPECT_EQ(reason_of(v),
            "in.osi: message 3: global_ground_truth.moving_object[1].base.position.y: not a finite "
            "number");
  v = test::view();
  v.lidar[0].reflections[2].time_of_flight_s = INFINITY;
  EXPECT_EQ(reason_of(v),
            "in.osi: message 3: lidar_sensor_view[0].reflection[2].time_of_flight: not a finite "
            "number");
  v = test::view();
  v.truth->moving[0].base.dimension_m->z() = -1;
  EXPECT_THAT(reason_of(v), testing::HasSubstr("moving_object[0].base.dimension: negative"));
  v = test::view();
  v.timestamp->nanos = 1'000'000'000;
  EXPECT_THAT(reason_of(v), testing::HasSubstr("timestamp.nanos: a second or more"));
  v = test::view();
  v.version->major = 4;
  EXPECT_THAT(reason_of(v), testing::HasSubstr("version.version_major: only version 3"));
  v = test::view();
  v.lidar[0].configuration->directions[1] = Vec3f::Zero();
  EXPECT_THAT(reason_of(v), testing::HasSubstr("directions[1]: no direction"));
}

TEST(Messages, AFieldOfAnotherWireTypeIsPassedOver) {
  // Field 2 (the time) as a number, then the sensor's number.
  const std::string bytes("\x10\x05\x1A\x02\x08\x07", 6);
  const osi::SensorView v = osi::read_sensor_view(bytes, "v");
  EXPECT_FALSE(v.timestamp);
  EXPECT_EQ(v.sensor_id, 7u);
}

TEST(Messages, TimestampsRoundToNanoseconds) {
  EXPECT_EQ(osi::Timestamp::of(1.9999999999), (osi::Timestamp{2, 0}));
  EXPECT_EQ(osi::Timestamp::of(-0.25), (osi::Timestamp{-1, 750'000'000}));
  EXPECT_EQ(osi::Timestamp::of(-0.25).s(), -0.25);
  EXPECT_THROW(osi::Timestamp::of(NAN), std::invalid_argument);
}

TEST(Messages, AnglesAreYawThenPitchThenRoll) {
  Stream random(5);
  for (int k = 0; k < 100; ++k) {
    const double roll = random.uniform(-3, 3), pitch = random.uniform(-1.5, 1.5);
    const double yaw = random.uniform(-3, 3);
    const Mat3 r = osi::rotation_of({roll, pitch, yaw}).toRotationMatrix();
    Mat3 rx, ry, rz;
    rx << 1, 0, 0, 0, cos(roll), -sin(roll), 0, sin(roll), cos(roll);
    ry << cos(pitch), 0, sin(pitch), 0, 1, 0, -sin(pitch), 0, cos(pitch);
    rz << cos(yaw), -sin(yaw), 0, sin(yaw), cos(yaw), 0, 0, 0, 1;
    EXPECT_LT((r - rz * ry * rx).norm(), 1e-12);
    EXPECT_LT((osi::roll_pitch_yaw_of(Eigen::Quaterniond(r)) - Vec3(roll, pitch, yaw)).norm(),
              1e-9);
  }
}

TEST(Messages, KindsAreTold) {
  EXPECT_EQ(osi::type_of_message(bytes_of(test::view())), osi::MessageType::kSensorView);
  EXPECT_EQ(osi::type_of_message(bytes_of(test::data())), osi::MessageType::kSensorData);
  EXPECT_EQ(osi::type_of_message(bytes_of(test::truth())), osi::MessageType::kGroundTruth);
  EXPECT_EQ(osi::type_of_message("\xFF\xFF"), std::nullopt);
}

}  // namespace
}  // namespace underbrush
