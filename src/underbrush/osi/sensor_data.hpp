/// \file
/// This file has the output of sensor models: OSI's message SensorData with the detections of
/// lidars, the detections in the vehicle's frame, and the detected objects.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/osi/sensor_view.hpp"

namespace underbrush::osi {

/// An echo of a lidar.
struct LidarDetection {
  double existence = 1;
  /// The detected object that it belongs to, if the message has it. It is no object of the ground
  /// truth, whose numbers the reflections have.
  uint64_t object_id = kNoId;
  /// Place in the sensor's own frame.
  double distance_m = 0, azimuth_rad = 0, elevation_rad = 0;
  double intensity_percent = 0;
  double reflectivity = 0;                    ///< 0 = not known.
  double pulse_width_m = 0;                   ///< 0 = not known.
  std::optional<double> radial_velocity_m_s;  ///< Positive towards the sensor.
  uint64_t beam_id = kNoId;
};

/// The header of a lidar's detections.
struct DetectionHeader {
  std::optional<Timestamp> measurement_time;
  std::optional<uint64_t> cycle_counter;
  std::optional<Mounting> mounting;  ///< Mounting of the lidar in the vehicle's frame.
  DataQualifier qualifier = DataQualifier::kUnknown;
  std::optional<uint32_t> valid_detections;
  std::optional<uint64_t> sensor_id;
};

/// The detections of one lidar.
struct LidarDetectionData {
  DetectionHeader header;
  std::vector<LidarDetection> detections;
};

/// A detection in the frame of the virtual sensor.
struct LogicalDetection {
  double existence = 1;
  uint64_t object_id = kNoId;  ///< As that of `LidarDetection`.
  Vec3 position_m = Vec3::Zero();
  double intensity_percent = 0;
  double pulse_width_m = 0;    ///< 0 = not known.
  uint64_t sensor_id = kNoId;  ///< The lidar that made it.
};

/// All detections in the frame of the virtual sensor.
struct LogicalDetectionData {
  std::optional<Timestamp> time;
  DataQualifier qualifier = DataQualifier::kUnknown;
  std::optional<uint32_t> valid_detections;
  std::vector<uint64_t> sensor_ids;
  std::vector<LogicalDetection> detections;
};

/// A class that an object may have.
struct Candidate {
  double probability = 0;
  uint32_t type = 0, vehicle_type = 0;  ///< As in `MovingObject`.
};

/// A detected object, in the frame of the virtual sensor. Velocities are relative to that frame.
struct DetectedObject {
  uint64_t tracking_id = kNoId;
  std::vector<uint64_t> ground_truth_ids;
  double existence = 0;
  double age_s = 0;
  uint32_t measurement_state = 0;  ///< 2 = measured, 3 = predicted.
  std::vector<uint64_t> sensor_ids;
  BaseMoving base, base_rmse;
  uint32_t reference_point = 0;  ///< 2 = the centre of the box.
  uint32_t movement_state = 0;   ///< 2 = stationary, 3 = moving.
  std::vector<Candidate> candidates;
};

/// The header of the detected objects.
struct ObjectHeader {
  std::optional<Timestamp> measurement_time;
  std::optional<uint64_t> cycle_counter;
  DataQualifier qualifier = DataQualifier::kUnknown;
};

/// The output of sensor models.
struct SensorData {
  std::optional<Version> version;
  std::optional<Timestamp> timestamp;
  std::optional<BaseMoving> host;  ///< The vehicle's frame in the world's, as it is known on board.
  std::optional<uint64_t> sensor_id;
  std::optional<Mounting> mounting;  ///< Mounting of the virtual sensor.
  /// The views that the data come from. They are shared, because they may be large.
  std::vector<std::shared_ptr<const SensorView>> views;
  std::optional<Timestamp> last_measurement_time;
  std::optional<ObjectHeader> object_header;
  std::vector<DetectedObject> objects;
  std::vector<LidarDetectionData> lidar;
  std::optional<LogicalDetectionData> logical;
  /// Polygons of the area that is known to be free, in the frame of the virtual sensor.
  std::vector<std::vector<Vec3>> free_area;
  /// Fields of the message that are not kept here, as they were read.
  std::string other;
};

/// The world's pose of the virtual sensor, in whose frame detections and objects are.
Pose world_from_virtual(const SensorData& data);

}  // namespace underbrush::osi
