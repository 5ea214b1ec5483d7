/// \file
/// This file has the point clouds that perception works on: those of single sensors (interface IF1
/// of [rosenberger20] Fig. 1), and the merged cloud of the vehicle (IF2).
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Perception: from the point clouds of a vehicle's sensors to lists of objects.
namespace perception {

/// The points of one sensor in one cycle (IF1). All columns are as long as `point_m`.
struct SensorCloud {
  uint16_t sensor = 0;         ///< Index in the rig.
  std::vector<Vec3f> point_m;  ///< In the sensor's frame at the point's own time.
  std::vector<double> time_s;  ///< By the sensor's clock.
  std::vector<float> intensity;
  std::vector<uint16_t> ring;
  /// Ends of the beams without a return, at the sensor's maximum range, in the sensor's frame, and
  /// their times. Only the occupancy grid uses them; they may be empty.
  std::vector<Vec3f> miss_m;
  std::vector<double> miss_time_s;

  size_t size() const { return point_m.size(); }
  /// Removes all points and keeps the memory.
  void clear();
  /// Throws `std::invalid_argument` where columns differ in length.
  void check() const;
};

/// The points of all sensors in the vehicle's frame at one time (IF2), in order of time. All
/// columns are as long as `point_m`.
struct MergedCloud {
  double time_s = 0;        ///< The time at which the frame has the pose below.
  double available_s = 0;   ///< Time at which the last point was available: its time plus latency.
  Pose world_from_vehicle;  ///< The pose of the frame at `time_s`.
  std::vector<Vec3f> point_m;   ///< In the vehicle's frame.
  std::vector<double> stamp_s;  ///< Time of each point by the vehicle's clock.
  std::vector<float> intensity;
  std::vector<uint16_t> ring;
  std::vector<uint16_t> sensor;       ///< Index in the rig.
  std::vector<Vec3f> miss_m;          ///< Ends of the beams without a return, vehicle's frame.
  std::vector<uint16_t> miss_sensor;  ///< Index in the rig of each of them.
  std::vector<Vec3f> sensor_m;        ///< Place of each sensor of the rig, vehicle's frame.

  size_t size() const { return point_m.size(); }
  /// Removes all points and keeps the memory.
  void clear();
};

}  // namespace perception
}  // namespace underbrush
