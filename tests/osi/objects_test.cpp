#include "underbrush/osi/objects.hpp"

#include <gmock/gmock.h>

#include "underbrush/osi/read.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush {
namespace {

TEST(Objects, ListsSurviveARoundTrip) {
  std::vector<perception::ObjectList> lists;
  for (int k = 0; k < 3; ++k) {
    perception::ObjectList list;
    list.time_s = list.available_s = 10 + 0.1 * k;
    list.world_from_vehicle.translation = Vec3(100 + k, 50, 2);
    list.world_from_vehicle.rotation = Eigen::AngleAxisd(0.4 + 0.05 * k, Vec3::UnitZ());
    perception::TrackedObject o;
    o.id = 9;
    o.truth_id = 4;
    o.label = perception::ObjectClass::kVan;
    o.probability[size_t(o.label)] = 0.75F;
    o.probability[size_t(perception::ObjectClass::kCar)] = 0.25F;
    o.existence = 0.9;
    o.age_s = 0.5;
    o.is_measured = true;
    o.box = {Vec3(110, 55, 3), -2.5, Vec3(5, 2, 2.2)};
    o.velocity_m_s = Vec3(3, -1, 0);
    o.acceleration_m_s2 = Vec3(0.5, 0, 0);
    o.yaw_rate_rad_s = 0.2;
    o.yaw_sigma_rad = 0.1;
    o.size_sigma_m = Vec3(0.3, 0.2, 0.1);
    o.speed_sigma_m_s = 0.4;
    list.objects = {o};
    lists.push_back(list);
  }
  const std::vector<osi::SensorData> data = osi::data_of(lists);
  ASSERT_EQ(data.size(), 3u);
  // A vehicle that turns at 0.5 rad/s moves an object that stands still in the vehicle's frame.
  EXPECT_NEAR(data[1].host->turn_rate_rad_s->z(), 0.5, 1e-9);
  EXPECT_NEAR(data[1].host->velocity_m_s->x(), 10, 1e-9);
  for (size_t k = 0; k < 3; ++k) {
    std::string bytes;
    osi::write(data[k], bytes);
    const perception::ObjectList back = osi::list_of(osi::read_sensor_data(bytes, "data"));
    ASSERT_EQ(back.objects.size(), 1u);
    const auto &a = lists[k].objects[0], &b = back.objects[0];
    EXPECT_NEAR(back.time_s, lists[k].time_s, 1e-9);
    EXPECT_EQ(b.id, a.id);
    EXPECT_EQ(b.truth_id, a.truth_id);
    EXPECT_EQ(b.label, a.label);
    EXPECT_EQ(b.probability, a.probability);
    EXPECT_EQ(b.is_measured, a.is_measured);
    EXPECT_LT((b.box.centre_m - a.box.centre_m).norm(), 1e-9);
    EXPECT_NEAR(b.box.yaw_rad, a.box.yaw_rad, 1e-9);
    EXPECT_EQ(b.box.size_m, a.box.size_m);
    EXPECT_LT((b.velocity_m_s - a.velocity_m_s).norm(), 1e-9);
    EXPECT_LT((b.acceleration_m_s2 - a.acceleration_m_s2).norm(), 1e-9);
    EXPECT_NEAR(b.yaw_rate_rad_s, a.yaw_rate_rad_s, 1e-9);
    EXPECT_EQ(b.size_sigma_m, a.size_sigma_m);
  }
}

TEST(Objects, AVehicleOfNoStatedKindHasTheClassOfItsSize) {
  const auto vehicle = [](osi::VehicleType type, const std::optional<Vec3>& size) {
    return osi::class_of(uint32_t(osi::ObjectType::kVehicle), uint32_t(type), size);
  };
  using perception::ObjectClass;
  using enum osi::VehicleType;
  for (const auto type : {kUnknown, kOther, kLandVehicle}) {
    EXPECT_EQ(vehicle(type, Vec3(5.0, 2.0, 1.5)), ObjectClass::kCar);
    EXPECT_EQ(vehicle(type, Vec3(5.3, 2.0, 2.5)), ObjectClass::kVan);
    EXPECT_EQ(vehicle(type, Vec3(12.0, 2.5, 3.8)), ObjectClass::kTruck);
    EXPECT_EQ(vehicle(type, Vec3(1.8, 0.6, 1.7)), ObjectClass::kCyclist);
    EXPECT_EQ(vehicle(type, Vec3(0.5, 0.5, 0.5)), ObjectClass::kOther);
    EXPECT_EQ(vehicle(type, {}), ObjectClass::kOther);
  }
  EXPECT_EQ(vehicle(kBus, Vec3(5.0, 2.0, 1.5)), ObjectClass::kTruck) << "a stated kind is kept";
}

TEST(Objects, RelativeVelocityIsTheChangeOfTheRelativePlace) {
  // An object that stands, seen from a vehicle that drives and turns: by differences in time.
  const auto place = [](double t) -> Vec3 {
    Pose vehicle;
    vehicle.translation = Vec3(8 * t, 2 * t, 0);
    vehicle.rotation = Eigen::AngleAxisd(0.3 + 0.5 * t, Vec3::UnitZ());
    return vehicle.inverse() * Vec3(30, 10, 1);
  };
  osi::SensorData d;
  d.host.emplace();
  d.host->position_m = Vec3::Zero();
  d.host->roll_pitch_yaw = Vec3(0, 0, 0.3);
  d.host->velocity_m_s = Vec3(8, 2, 0);
  d.host->turn_rate_rad_s = Vec3(0, 0, 0.5);
  perception::ObjectList list;
  perception::TrackedObject o;
  o.id = 1;
  o.box.centre_m = Vec3(30, 10, 1);
  o.box.size_m = Vec3(1, 1, 1);
  list.objects = {o};
  osi::set_objects(list, {}, d);
  const Vec3 change = (place(1e-5) - place(-1e-5)) / 2e-5;
  EXPECT_LT((*d.objects[0].base.velocity_m_s - change).norm(), 1e-6);
}

}  // namespace
}  // namespace underbrush
