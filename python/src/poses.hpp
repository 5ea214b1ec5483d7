/// \file
/// Poses that Python gives.
#pragma once
#include <Eigen/Core>
#include <variant>

#include "underbrush/core/pose.hpp"

namespace underbrush::python {

/// A pose as a value, or as a 4 × 4 matrix.
using GivenPose = std::variant<Pose, Eigen::Matrix4d>;

/// Returns the pose of a 4 × 4 matrix. Throws `std::invalid_argument` unless it is one within
/// 0.005.
Pose pose_from_matrix(const Eigen::Matrix4d& matrix);

/// Returns the pose that was given.
inline Pose pose_of(const GivenPose& given) {
  if (const Pose* p = std::get_if<Pose>(&given)) return *p;
  return pose_from_matrix(std::get<Eigen::Matrix4d>(given));
}

}  // namespace underbrush::python
