/// \file
/// This file has the rig: the sensors of a vehicle and their mounting.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::perception {

/// Name of the extra column of a log with the index of the rig's sensor that fired a beam (uint8).
inline constexpr const char* kSensorColumn = "sensor";

/// A sensor and its place on the vehicle. The vehicle's frame has x forward, y left and z up.
struct MountedSensor {
  std::string name;    ///< Unique in the rig.
  std::string sensor;  ///< Name in the catalogue, or path of a YAML file.
  Pose vehicle_from_sensor;
  double latency_s = 0;       ///< Time from a point's measurement until it can be processed.
  double clock_offset_s = 0;  ///< The sensor's clock less the vehicle's clock.
};

/// The sensors of a vehicle.
struct Rig {
  std::string name;
  std::vector<MountedSensor> sensors;
};

/// Reads a rig from a YAML file, whose keys are in docs/reference/sensor-files.md. Paths of sensors
/// are relative to the file's folder. Throws `FormatError`.
Rig load_rig(const std::string& path);

}  // namespace underbrush::perception
