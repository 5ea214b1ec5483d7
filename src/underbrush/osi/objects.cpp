#include "underbrush/osi/objects.hpp"

#include <algorithm>
#include <array>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/size_prior.hpp"

namespace underbrush::osi {
namespace {

using perception::kClassCount;
using perception::ObjectClass;
using perception::ObjectList;
using perception::TrackedObject;

constexpr double kMoves = 0.3;       // m/s
constexpr double kLeastShare = 0.5;  // Probability of a class below which it counts as unknown.

// The motion of the virtual sensor in the world.
struct Frame {
  Pose world_from_virtual;
  Vec3 origin = Vec3::Zero(), velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  Vec3 turn = Vec3::Zero();

  explicit Frame(const SensorData& d) : world_from_virtual(osi::world_from_virtual(d)) {
    if (!d.host) return;
    origin = d.host->position_m.value_or(Vec3::Zero());
    velocity = d.host->velocity_m_s.value_or(Vec3::Zero());
    acceleration = d.host->acceleration_m_s2.value_or(Vec3::Zero());
    turn.z() = d.host->turn_rate_rad_s.value_or(Vec3::Zero()).z();
  }
  Vec3 velocity_at(const Vec3& place) const { return velocity + turn.cross(Vec3(place - origin)); }
};

// The standard deviations along other axes.
Vec3 turned_sigma(const Eigen::Quaterniond& rotation, const Vec3& sigma) {
  const Mat3 r = rotation.toRotationMatrix();
  return r.cwiseAbs2().operator*(sigma.cwiseAbs2()).cwiseSqrt();
}

void set_candidates(const TrackedObject& o, DetectedObject& out) {
  std::array<size_t, kClassCount> order{};
  for (size_t c = 0; c < kClassCount; ++c) order[c] = c;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return o.probability[a] > o.probability[b]; });
  for (const size_t c : order) {
    if (o.probability[c] > 0) {
      out.candidates.push_back(candidate_of(ObjectClass(c), double(o.probability[c])));
    }
  }
  if (out.candidates.empty()) out.candidates.push_back(candidate_of(o.label, 1));
}

DetectedObject detected(const TrackedObject& o, const Frame& frame) {
  const Pose back = frame.world_from_virtual.inverse();
  DetectedObject d;
  d.tracking_id = o.id;
  if (o.truth_id) d.ground_truth_ids = {o.truth_id - 1};
  d.existence = o.existence;
  d.age_s = o.age_s;
  d.measurement_state = o.is_measured ? 2 : 3;
  d.base.dimension_m = o.box.size_m;
  d.base.position_m = back * o.box.centre_m;
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(o.box.yaw_rad, Vec3::UnitZ()));
  d.base.roll_pitch_yaw = roll_pitch_yaw_of(back.rotation * heading);
  d.base.velocity_m_s = back.rotation * (o.velocity_m_s - frame.velocity_at(o.box.centre_m));
  d.base.acceleration_m_s2 = back.rotation * (o.acceleration_m_s2 - frame.acceleration);
  d.base.turn_rate_rad_s = Vec3(0, 0, o.yaw_rate_rad_s - frame.turn.z());
  d.base_rmse.dimension_m = o.size_sigma_m;
  d.base_rmse.position_m = turned_sigma(back.rotation, o.position_sigma_m);
  d.base_rmse.roll_pitch_yaw = Vec3(0, 0, o.yaw_sigma_rad);
  d.base_rmse.velocity_m_s = Vec3(o.speed_sigma_m_s, o.speed_sigma_m_s, 0);
  d.reference_point = 2;
  d.movement_state = o.velocity_m_s.norm() > kMoves ? 3 : 2;
  set_candidates(o, d);
  return d;
}

TrackedObject tracked(const DetectedObject& d, const Frame& frame) {
  const Pose& pose = frame.world_from_virtual;
  TrackedObject o;
  o.id = d.tracking_id;
  if (!d.ground_truth_ids.empty() && d.ground_truth_ids[0] < kNoId) {
    o.truth_id = d.ground_truth_ids[0] + 1;
  }
  o.existence = d.existence;
  o.age_s = d.age_s;
  o.is_measured = d.measurement_state == 2;
  o.box.size_m = d.base.dimension_m.value_or(Vec3::Zero());
  const Vec3 at = d.base.position_m.value_or(Vec3::Zero());
  o.box.centre_m = o.reference_m = pose * at;
  const auto turned = pose.rotation * rotation_of(d.base.roll_pitch_yaw.value_or(Vec3::Zero()));
  const Vec3 forward = turned * Vec3::UnitX();
  o.box.yaw_rad = perception::wrapped(std::atan2(forward.y(), forward.x()));
  o.velocity_m_s = pose.rotation * d.base.velocity_m_s.value_or(Vec3::Zero()) +
                   frame.velocity_at(o.box.centre_m);
  o.acceleration_m_s2 =
      pose.rotation * d.base.acceleration_m_s2.value_or(Vec3::Zero()) + frame.acceleration;
  o.yaw_rate_rad_s = d.base.turn_rate_rad_s.value_or(Vec3::Zero()).z() + frame.turn.z();
  o.size_sigma_m = d.base_rmse.dimension_m.value_or(Vec3::Zero());
  o.position_sigma_m = turned_sigma(pose.rotation, d.base_rmse.position_m.value_or(Vec3::Zero()));
  o.yaw_sigma_rad = d.base_rmse.roll_pitch_yaw.value_or(Vec3::Zero()).z();
  o.speed_sigma_m_s = d.base_rmse.velocity_m_s.value_or(Vec3::Zero()).x();
  for (const Candidate& c : d.candidates) {
    o.probability[size_t(class_of(c.type, c.vehicle_type))] += float(c.probability);
  }
  const auto best = std::max_element(o.probability.begin(), o.probability.end());
  if (double(*best) >= kLeastShare) o.label = ObjectClass(best - o.probability.begin());
  return o;
}

// The motion of the vehicle between the lists before and after list k.
void set_motion(std::span<const ObjectList> lists, size_t k, BaseMoving& host) {
  const ObjectList& a = lists[k > 0 ? k - 1 : k];
  const ObjectList& b = lists[std::min(k + 1, lists.size() - 1)];
  const double dt = b.time_s - a.time_s;
  if (!(dt > 0)) return;
  const Pose &from = a.world_from_vehicle, &to = b.world_from_vehicle;
  host.velocity_m_s = (to.translation - from.translation) / dt;
  const double yaw = roll_pitch_yaw_of(to.rotation).z() - roll_pitch_yaw_of(from.rotation).z();
  host.turn_rate_rad_s = Vec3(0, 0, perception::wrapped(yaw) / dt);
}

}  // namespace

ObjectClass class_of(uint32_t type, uint32_t vehicle_type, const std::optional<Vec3>& size_m) {
  if (type == uint32_t(ObjectType::kPedestrian)) return ObjectClass::kPedestrian;
  if (type == uint32_t(ObjectType::kOther) || type == uint32_t(ObjectType::kAnimal)) {
    return ObjectClass::kOther;
  }
  if (type != uint32_t(ObjectType::kVehicle)) return ObjectClass::kUnknown;
  switch (VehicleType(vehicle_type)) {
    case VehicleType::kSmallCar:
    case VehicleType::kCompactCar:
    case VehicleType::kMediumCar:
    case VehicleType::kLuxuryCar:
      return ObjectClass::kCar;
    case VehicleType::kDeliveryVan:
      return ObjectClass::kVan;
    case VehicleType::kHeavyTruck:
    case VehicleType::kSemitractor:
    case VehicleType::kSemitrailer:
    case VehicleType::kTrailer:
    case VehicleType::kBus:
    case VehicleType::kTram:
    case VehicleType::kTrain:
      return ObjectClass::kTruck;
    case VehicleType::kMotorbike:
    case VehicleType::kBicycle:
    case VehicleType::kStandupScooter:
    case VehicleType::kMicromobility:
      return ObjectClass::kCyclist;
    case VehicleType::kUnknown:
    case VehicleType::kOther:
    case VehicleType::kLandVehicle:
      return size_m ? perception::vehicle_of(*size_m) : ObjectClass::kOther;
    default:
      return ObjectClass::kOther;
  }
}

Candidate candidate_of(ObjectClass label, double probability) {
  const auto vehicle = [&](VehicleType type) {
    return Candidate{probability, uint32_t(ObjectType::kVehicle), uint32_t(type)};
  };
  switch (label) {
    case ObjectClass::kCar:
      return vehicle(VehicleType::kMediumCar);
    case ObjectClass::kVan:
      return vehicle(VehicleType::kDeliveryVan);
    case ObjectClass::kTruck:
      return vehicle(VehicleType::kHeavyTruck);
    case ObjectClass::kCyclist:
      return vehicle(VehicleType::kBicycle);
    case ObjectClass::kPedestrian:
      return {probability, uint32_t(ObjectType::kPedestrian), 0};
    case ObjectClass::kOther:
      return {probability, uint32_t(ObjectType::kOther), 0};
    default:
      return {probability, uint32_t(ObjectType::kUnknown), 0};
  }
}

void truth_of(const GroundTruth& truth, std::optional<uint64_t> host, std::string_view source,
              perception::TruthFrame& frame) {
  if (!host) host = truth.host_vehicle_id;
  frame.time_s = truth.timestamp ? truth.timestamp->s() : 0;
  frame.objects.clear();
  for (size_t k = 0; k < truth.moving.size(); ++k) {
    const MovingObject& m = truth.moving[k];
    if (m.id == host || !m.base.position_m || !m.base.dimension_m || m.id == kNoId) continue;
    const Vec3 forward = m.base.pose().rotation * Vec3::UnitX();
    frame.objects.push_back(
        {m.id + 1,
         class_of(m.type, m.vehicle_type, m.base.dimension_m),
         {*m.base.position_m, std::atan2(forward.y(), forward.x()), *m.base.dimension_m}});
    for (size_t j = 0; j + 1 < frame.objects.size(); ++j) {
      if (frame.objects[j].id != m.id + 1) continue;
      throw FormatError(source, "moving_object[" + std::to_string(k) + "].id",
                        "two objects have the number " + std::to_string(m.id));
    }
  }
}

GroundTruth ground_truth_of(const perception::TruthFrame& frame, const Pose& world_from_vehicle,
                            double time_s) {
  GroundTruth t;
  t.version = Version{};
  t.timestamp = Timestamp::of(time_s);
  t.host_vehicle_id = kHostId;
  MovingObject host;
  host.id = kHostId;
  host.centre_to_rear_m = Vec3(-1.4, 0, -0.75);
  host.base.dimension_m = Vec3(4.5, 1.8, 1.5);
  host.base.position_m = world_from_vehicle * Vec3(-*host.centre_to_rear_m);
  host.base.roll_pitch_yaw = roll_pitch_yaw_of(world_from_vehicle.rotation);
  const Candidate car = candidate_of(ObjectClass::kCar, 1);
  host.type = car.type;
  host.vehicle_type = car.vehicle_type;
  t.moving.push_back(host);
  for (const perception::TruthObject& o : frame.objects) {
    MovingObject m;
    m.id = o.id - 1;
    m.base.dimension_m = o.box.size_m;
    m.base.position_m = o.box.centre_m;
    m.base.roll_pitch_yaw = Vec3(0, 0, o.box.yaw_rad);
    const Candidate type = candidate_of(o.label, 1);
    m.type = type.type;
    m.vehicle_type = type.vehicle_type;
    t.moving.push_back(m);
  }
  return t;
}

void set_objects(const ObjectList& list, std::span<const uint64_t> sensor_ids, SensorData& data) {
  const Frame frame(data);
  if (!data.object_header) data.object_header.emplace();
  data.object_header->measurement_time = Timestamp::of(list.time_s);
  data.object_header->qualifier = DataQualifier::kAvailable;
  data.objects.clear();
  for (const TrackedObject& o : list.objects) {
    data.objects.push_back(detected(o, frame));
    data.objects.back().sensor_ids.assign(sensor_ids.begin(), sensor_ids.end());
  }
}

ObjectList list_of(const SensorData& data) {
  const Frame frame(data);
  ObjectList list;
  if (data.timestamp) list.time_s = list.available_s = data.timestamp->s();
  if (data.last_measurement_time) list.time_s = data.last_measurement_time->s();
  if (data.object_header && data.object_header->measurement_time) {
    list.time_s = data.object_header->measurement_time->s();
  }
  list.available_s = std::max(list.available_s, list.time_s);
  list.world_from_vehicle = data.host ? data.host->pose() : Pose{};
  for (const DetectedObject& d : data.objects) list.objects.push_back(tracked(d, frame));
  std::stable_sort(list.objects.begin(), list.objects.end(),
                   [](const TrackedObject& a, const TrackedObject& b) { return a.id < b.id; });
  return list;
}

std::vector<SensorData> data_of(std::span<const ObjectList> lists) {
  std::vector<SensorData> out;
  for (size_t k = 0; k < lists.size(); ++k) {
    SensorData d;
    d.version = Version{};
    d.timestamp = Timestamp::of(lists[k].available_s);
    d.host.emplace();
    d.host->position_m = lists[k].world_from_vehicle.translation;
    d.host->roll_pitch_yaw = roll_pitch_yaw_of(lists[k].world_from_vehicle.rotation);
    set_motion(lists, k, *d.host);
    d.sensor_id = 0;
    d.mounting = Mounting::of({});
    d.last_measurement_time = Timestamp::of(lists[k].time_s);
    d.object_header = ObjectHeader{std::nullopt, k, DataQualifier::kAvailable};
    set_objects(lists[k], std::vector<uint64_t>{0}, d);
    out.push_back(std::move(d));
  }
  return out;
}

}  // namespace underbrush::osi
