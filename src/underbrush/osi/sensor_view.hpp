/// \file
/// This file has the ground truth of a simulation and the views of its sensors: OSI's messages
/// GroundTruth, SensorView and LidarSensorView.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/osi/common.hpp"

namespace underbrush::osi {

/// A road user of the ground truth.
struct MovingObject {
  uint64_t id = kNoId;
  BaseMoving base;                       ///< In the world's frame.
  uint32_t type = 0;                     ///< A number of `ObjectType`, or a later one.
  uint32_t vehicle_type = 0;             ///< A number of `VehicleType`, or a later one.
  std::optional<Vec3> centre_to_rear_m;  ///< From the box's centre to the rear axle, in its frame.
  std::string model_reference;
};

/// A stationary thing of the ground truth.
struct StationaryObject {
  uint64_t id = kNoId;
  std::optional<Vec3> dimension_m, position_m, roll_pitch_yaw;
  std::string model_reference;
};

/// The state of the world at one time. Lanes, signs and lights are not kept; `lanes` counts them.
struct GroundTruth {
  std::optional<Version> version;
  std::optional<Timestamp> timestamp;
  std::optional<uint64_t> host_vehicle_id;
  std::vector<MovingObject> moving;
  std::vector<StationaryObject> stationary;
  uint64_t lanes = 0;

  /// The moving object with a number, or null.
  const MovingObject* find(uint64_t id) const;
};

/// A return of one ray. A ray that met nothing is an empty reflection.
struct Reflection {
  double signal_db = 0;         ///< Power that comes back, relative to the power that was sent.
  double time_of_flight_s = 0;  ///< There and back; 0 = nothing came back.
  double doppler_shift_hz = 0;
  uint64_t object_id = kNoId;
  Vec3f normal = Vec3f::Zero();  ///< Surface normal in the sensor's frame; zero = not known.
  bool has_doppler = false;

  bool is_miss() const { return time_of_flight_s <= 0; }
};

/// The configuration of a lidar's rays.
///
/// OSI has neither beams nor empty rays. Our convention is that the reflections of a view are
/// dense, with one entry per ray: ray k of beam b has the index b · rays per beam + k, and a ray
/// that met nothing has an empty reflection. `num_of_pixels` is the number of beams.
struct LidarConfiguration {
  std::optional<uint64_t> sensor_id;
  std::optional<Mounting> mounting;  ///< In the vehicle's frame.
  std::optional<double> field_horizontal_rad, field_vertical_rad;
  std::optional<uint32_t> rays_horizontal, rays_vertical, most_interactions, beams;
  std::optional<double> emitter_frequency_hz;
  std::vector<Vec3f> directions;     ///< Unit vectors of the rays in the sensor's frame.
  std::vector<uint32_t> timings_us;  ///< Firing time of each ray, µs after the view's time.
};

/// The view of one lidar.
struct LidarSensorView {
  std::optional<LidarConfiguration> configuration;
  std::vector<Reflection> reflections;
};

/// The input of sensor models: the ground truth, and the output of environment simulators.
struct SensorView {
  std::optional<Version> version;
  std::optional<Timestamp> timestamp;
  std::optional<uint64_t> sensor_id;
  std::optional<Mounting>
      mounting;  ///< Mounting of the virtual sensor, in whose frame objects are listed.
  std::optional<GroundTruth> truth;
  std::optional<uint64_t> host_vehicle_id;
  std::vector<LidarSensorView> lidar;
  /// The message as it was read, so that it can be passed on with all that is not kept here.
  std::string bytes;

  /// The host vehicle in the ground truth, or null.
  const MovingObject* host() const;
};

/// The pose of a vehicle's frame, whose origin is the middle of the rear axle, in the world's
/// frame. Without `centre_to_rear_m` the origin is the box's centre.
Pose world_from_vehicle(const MovingObject& vehicle);

/// The sensor view that a sensor model requests from an environment simulator.
struct SensorViewConfiguration {
  std::optional<Version> version;
  std::optional<uint64_t> sensor_id;
  std::optional<Mounting> mounting;
  std::optional<double> field_horizontal_rad, field_vertical_rad, range_m, cycle_s;
  std::vector<LidarConfiguration> lidar;
};

}  // namespace underbrush::osi
