/// \file
/// Rigid transforms. Frames are right-handed, z up, in metres. Their names have the form
/// `to_from_from`, as in `world_from_sensor`.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <vector>

namespace underbrush {

using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat3f = Eigen::Matrix3f;

/// One degree, rad.
inline constexpr double kDegree = M_PI / 180;

/// A rigid transform x ↦ R x + t. `rotation` is kept at unit norm.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 translation = Vec3::Zero();

  Vec3 operator*(const Vec3& point) const { return rotation * point + translation; }
  Pose operator*(const Pose& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Pose inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back, -(back * translation)};
  }
};

/// Interpolates from `a` (s = 0) to `b` (s = 1): the rotation by slerp, the translation along a
/// straight line. Outside [0, 1] it extrapolates at the same rate.
Pose interpolate(const Pose& a, const Pose& b, double s);

/// A pose and its time (s).
struct StampedPose {
  double time_s = 0;
  Pose world_from_sensor;
};

/// Poses over time, in ascending order of time.
class Trajectory {
 public:
  Trajectory() = default;
  /// Sorts the poses by time. Throws `std::invalid_argument` if two poses share a time or a value
  /// is not finite.
  explicit Trajectory(std::vector<StampedPose> poses);

  bool empty() const { return poses_.empty(); }
  const std::vector<StampedPose>& poses() const { return poses_; }

  /// Returns the interpolated pose at `time_s`. Outside the recorded span it is extrapolated from
  /// the first or last two poses, by at most `kMaxExtrapolation` of their interval; farther out
  /// there is no pose.
  std::optional<Pose> at(double time_s) const;

  static constexpr double kMaxExtrapolation = 1.0;

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace underbrush
