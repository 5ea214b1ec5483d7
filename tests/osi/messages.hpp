/// \file
/// Messages with every field that the module knows.
#pragma once
#include "underbrush/osi/sensor_data.hpp"

namespace underbrush::test {

inline osi::BaseMoving base(double x) {
  osi::BaseMoving b;
  b.dimension_m = Vec3(4.5, 1.8, 1.5);
  b.position_m = Vec3(x, -2.25, 0.75);
  b.roll_pitch_yaw = Vec3(0.01, -0.02, 1.5);
  b.velocity_m_s = Vec3(12, 0.5, 0);
  b.acceleration_m_s2 = Vec3(1, 0, -0.25);
  b.turn_rate_rad_s = Vec3(0, 0, 0.125);
  return b;
}

inline osi::GroundTruth truth() {
  osi::GroundTruth t;
  t.version = osi::Version{};
  t.timestamp = osi::Timestamp{12, 500'000'000};
  t.host_vehicle_id = 0;
  osi::MovingObject host;
  host.id = 0;
  host.base = base(100);
  host.type = 2;
  host.vehicle_type = 4;
  host.centre_to_rear_m = Vec3(-1.4, 0, -0.3);
  host.model_reference = "car.glb";
  osi::MovingObject walker;
  walker.id = 7;
  walker.base = base(110);
  walker.type = 3;
  t.moving = {host, walker};
  t.stationary = {{42, Vec3(10, 5, 3), Vec3(90, 20, 1.5), Vec3(0, 0, 0.3), "house"}};
  return t;
}

inline osi::SensorView view() {
  osi::SensorView v;
  v.version = osi::Version{};
  v.timestamp = osi::Timestamp{12, 500'000'000};
  v.sensor_id = 3;
  v.mounting = osi::Mounting{Vec3(1.5, 0, 1.7), Vec3(0, 0.02, 0)};
  v.truth = truth();
  v.host_vehicle_id = 0;
  osi::LidarSensorView l;
  osi::LidarConfiguration c;
  c.sensor_id = 9;
  c.mounting = osi::Mounting{Vec3(3.5, 0.5, 0.5), std::nullopt};
  c.field_horizontal_rad = 1.5;
  c.field_vertical_rad = 0.1;
  c.rays_horizontal = 3;
  c.rays_vertical = 1;
  c.most_interactions = 1;
  c.emitter_frequency_hz = 3.3126e14;
  c.beams = 3;
  c.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  c.timings_us = {0, 300, 70000};
  l.configuration = c;
  l.reflections = {
      {-40, 1e-7, 0, 7, {-1, 0, 0}, false}, {}, {-60.5, 2e-7, 100, osi::kNoId, {0, 0, 1}, true}};
  v.lidar = {l};
  return v;
}

inline osi::SensorData data() {
  osi::SensorData d;
  d.version = osi::Version{};
  d.timestamp = osi::Timestamp{12, 500'000'000};
  d.host = base(100);
  d.sensor_id = 3;
  d.mounting = osi::Mounting{Vec3(1.5, 0, 1.7), Vec3(0, 0.02, 0)};
  d.last_measurement_time = osi::Timestamp{12, 400'000'000};
  d.object_header =
      osi::ObjectHeader{osi::Timestamp{12, 400'000'000}, 17, osi::DataQualifier::kAvailable};
  osi::DetectedObject o;
  o.tracking_id = 5;
  o.ground_truth_ids = {7};
  o.existence = 0.8;
  o.age_s = 1.25;
  o.measurement_state = 2;
  o.sensor_ids = {9};
  o.base = base(8);
  o.base_rmse.dimension_m = Vec3(0.3, 0.1, 0.1);
  o.base_rmse.position_m = Vec3(0.1, 0.1, 0.05);
  o.reference_point = 2;
  o.movement_state = 3;
  o.candidates = {{0.75, 2, 4}, {0.25, 3, 0}};
  d.objects = {o};
  osi::LidarDetectionData l;
  l.header = {osi::Timestamp{12, 400'000'000}, 17, osi::Mounting{Vec3(3.5, 0.5, 0.5), std::nullopt},
              osi::DataQualifier::kAvailable,  2,  9};
  l.detections = {{1, 7, 15, 0.1, -0.02, 30, 0.4, 0.8, -3.0, 0},
                  {0.5, osi::kNoId, 20, 0, 0, 0, 0, 0, {}, 2}};
  d.lidar = {l};
  osi::LogicalDetectionData logical;
  logical.time = osi::Timestamp{12, 400'000'000};
  logical.qualifier = osi::DataQualifier::kReduced;
  logical.valid_detections = 1;
  logical.sensor_ids = {9};
  logical.detections = {{1, 7, {15, 2, 0.5}, 30, 0.8, 9}};
  d.logical = logical;
  d.free_area = {{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}};
  return d;
}

}  // namespace underbrush::test
