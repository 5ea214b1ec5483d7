/// \file
/// An object of a site: class, pose and box.
#pragma once
#include <cmath>
#include <filesystem>

#include "underbrush/core/pose.hpp"
#include "underbrush/elements/classes.hpp"

namespace underbrush::primitives {

/// A box in an object's frame (m).
struct Box {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
  Vec3 size() const { return max - min; }
};

/// (c, q, box) of [tallavajhula18] §IV. The pose stands on the ground under the centroid of the
/// object's points and is turned about z alone, x along the longer principal axis of the points
/// seen from above; the box's bottom is the ground (z = 0).
struct PlacedObject {
  elements::Class label = elements::Class::kUnknown;
  Vec3 position = Vec3::Zero();  ///< m, world.
  double yaw_rad = 0;
  Box box;
  uint32_t instance = 0;  ///< Number in the labelled log, 0 = none. Cells of a patch share it.
  size_t points = 0;      ///< That it was measured from.
  /// Poses of the foot over time (TUM, world from object), for an object that moves; empty =
  /// stands.
  std::filesystem::path trajectory;

  Pose world_from_object() const {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())), position};
  }
};

/// As files hold it: to the millimetre, and 0.01 mrad; what was measured is known no better.
inline Vec3 as_written(const Vec3& v) { return (v * 1000).array().round() / 1000; }
/// ... its corners.
inline Box as_written(const Box& box) { return {as_written(box.min), as_written(box.max)}; }
/// ... its position, heading and box.
inline PlacedObject as_written(PlacedObject o) {
  o.position = as_written(o.position);
  o.yaw_rad = std::round(o.yaw_rad * 1e5) / 1e5;
  o.box = as_written(o.box);
  return o;
}

}  // namespace underbrush::primitives
