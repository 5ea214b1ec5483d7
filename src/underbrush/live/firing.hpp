/// \file
/// The requests of clients of the sensor server, and the answers.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Sensors that fire on demand, for simulations in closed loop.
namespace live {

/// The time at which a call ends, whether it was answered or not.
using Deadline = std::chrono::system_clock::time_point;

/// A motion: poses over time (world from body), or one pose with the velocities that it has from
/// then on.
struct Motion {
  std::vector<StampedPose> poses;
  Vec3 velocity_m_per_s = Vec3::Zero();     ///< World frame; a single pose has it.
  Vec3 turn_rate_rad_per_s = Vec3::Zero();  ///< World frame; a single pose has it.
};

/// The motion of an actor in the world during a firing. It stands still before its first pose and
/// after its last. Several actors of one name, such as the poses of a walking person, keep their
/// times; a single one is there all the time.
struct ActorMotion {
  std::string name;
  Motion motion;
  bool is_absent = false;  ///< Whether no beam meets it; the motion has no meaning then.
};

/// A part of the time in which sensors fire, and the motions of everything in it.
struct Firing {
  double start_s = 0;              ///< s; the beginning of the sensors' firing.
  double from_s = 0, until_s = 0;  ///< s; beams of [from_s, until_s) are fired.
  /// The vehicle, or the only sensor. It has poses for all of the time.
  Motion vehicle;
  std::vector<ActorMotion> actors;  ///< All others move as in the file of the world.
  /// Numbers of the first beam of each sensor, and of the first scan, at `start_s`.
  size_t first_beam = 0;
  uint32_t first_scan = 0;
};

/// Part of a column, as bytes: little-endian values without gaps.
struct Column {
  std::string name;
  const char* type = "<f4";  ///< The type's name in NumPy.
  uint32_t width = 1;        ///< The number of values per row.
  std::string bytes;
};

/// A field of a cloud, as in sensor_msgs/PointField.
struct PointField {
  std::string name;
  uint32_t offset = 0, datatype = 0;
};

/// The points of a sensor, as in sensor_msgs/PointCloud2.
struct PointCloud {
  std::string sensor;
  StampedPose world_from_sensor;  ///< At the beginning of the firing.
  uint32_t height = 1, width = 0, point_step = 0;
  std::vector<PointField> fields;
  std::string bytes;
};

/// A part of the rows of an answer: columns, or the cloud of a sensor.
struct Part {
  uint64_t first_row = 0, rows = 0;
  std::vector<Column> columns;
  std::vector<PointCloud> clouds;
};

}  // namespace live
}  // namespace underbrush
