/// \file
/// The sensor's motion, from which a chunk's origins and directions are predicted.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/compact/cursor.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::compact {

/// A vector of doubles without Eigen's freedom of evaluation.
struct Vector {
  double x = 0, y = 0, z = 0;
};

/// A rotation as a quaternion w + (x, y, z).
struct Turn {
  double w = 1, x = 0, y = 0, z = 0;
};

/// Returns R v.
inline Vector rotated(const Turn& q, const Vector& v) {
  const Vector u = {2 * (q.y * v.z - q.z * v.y), 2 * (q.z * v.x - q.x * v.z),
                    2 * (q.x * v.y - q.y * v.x)};
  return {v.x + q.w * u.x + (q.y * u.z - q.z * u.y), v.y + q.w * u.y + (q.z * u.x - q.x * u.z),
          v.z + q.w * u.z + (q.x * u.y - q.y * u.x)};
}
/// Returns the inverse rotation.
inline Turn reverse(const Turn& q) { return {q.w, -q.x, -q.y, -q.z}; }

/// The position and rotation of the sensor at a time.
struct Place {
  Vector position;
  Turn turn;
};

/// The motion between two poses: `interpolate` of core/pose.hpp with its angle and axis worked out.
struct Segment {
  double begin_s = 0, end_s = 0;
  Vector from, to;          ///< m, world.
  Turn start;               ///< Rotation at `begin_s`.
  double half_angle = 0;    ///< rad; half of the rotation from begin to end.
  Vector axis = {1, 0, 0};  ///< Unit vector, in the sensor's frame.
};

/// A motion along segments, one after the other. Without segments the sensor rests at zero.
class Track {
 public:
  Track() = default;
  /// The segments of the log's scan poses that `Trajectory::at` would use between two times. It has
  /// none where the log has fewer than two scans, or times or poses that make no trajectory.
  Track(const std::vector<ScanInfo>& scans, double first_s, double last_s);

  bool empty() const { return segments_.empty(); }
  /// The position has the bits of `Trajectory::at`, without its limit of extrapolation.
  Place at(double time_s) const;

  void append_to(std::string& out) const;
  static Track read(Cursor& in);

 private:
  std::vector<Segment> segments_;
};

}  // namespace underbrush::compact
