/// \file
/// The values of an object by name, for the readers and writers of lists. This file is internal to
/// the module.
#pragma once
#include <array>
#include <span>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// A value of an object: its name in files, and the access to it.
struct ObjectColumn {
  const char* name;
  double& (*value)(TrackedObject&);
};

/// All values that are numbers with a fraction, in the order of the files.
std::span<const ObjectColumn> object_columns();

/// The names of the vehicle's position (m) and rotation (quaternion), in the order of
/// `pose_values`.
inline constexpr std::array<const char*, 7> kPoseColumns{
    "vehicle_x", "vehicle_y", "vehicle_z", "vehicle_qx", "vehicle_qy", "vehicle_qz", "vehicle_qw"};
/// A pose as seven numbers.
inline std::array<double, 7> pose_values(const Pose& p) {
  return {p.translation.x(), p.translation.y(), p.translation.z(), p.rotation.x(),
          p.rotation.y(),    p.rotation.z(),    p.rotation.w()};
}
/// The pose of seven numbers; nothing unless the quaternion's length is 1 within 0.005.
inline std::optional<Pose> pose_of_values(const std::array<double, 7>& v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1) < 0.005)) return std::nullopt;
  return Pose{q, {v[0], v[1], v[2]}};
}

}  // namespace underbrush::perception
