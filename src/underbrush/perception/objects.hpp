/// \file
/// This file has the objects of perception: true ones, tracked ones, and lists of them (interface
/// IF3 of [rosenberger20] Fig. 1).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::perception {

/// The class of a road user. `kOther` is anything else that stands above the ground.
enum class ObjectClass : uint8_t { kUnknown, kCar, kVan, kTruck, kCyclist, kPedestrian, kOther };
/// The number of classes.
inline constexpr size_t kClassCount = 7;
/// The name of a class in files, such as "car".
std::string_view name(ObjectClass label);
/// The class of a name, in small or capital letters; nothing for an unknown name.
std::optional<ObjectClass> class_of_name(std::string_view name);

/// Reduces an angle to [−π, π).
inline double wrapped(double angle_rad) {
  const double turns = std::floor((angle_rad + M_PI) / (2 * M_PI));
  return angle_rad - 2 * M_PI * turns;
}

/// A box that is turned about z.
struct OrientedBox {
  Vec3 centre_m = Vec3::Zero();
  double yaw_rad = 0;          ///< Direction of the length, counter-clockwise from x.
  Vec3 size_m = Vec3::Zero();  ///< Length, width, height.

  /// Moves a point to the frame of the box, which has its origin in the centre and x along the
  /// length.
  Vec3 to_box(const Vec3& point) const;
  /// The inverse of `to_box`.
  Vec3 from_box(const Vec3& point) const;
};

/// An object of the ground truth, in the world's frame.
struct TruthObject {
  uint64_t id = 0;  ///< Not 0.
  ObjectClass label = ObjectClass::kUnknown;
  OrientedBox box;
};

/// The ground truth at one time.
struct TruthFrame {
  double time_s = 0;
  std::vector<TruthObject> objects;
};

/// A tracked object, in the world's frame.
struct TrackedObject {
  uint64_t id = 0;        ///< Number of the track; not 0.
  uint64_t truth_id = 0;  ///< Number of the true object that its points belong to; 0 = not known.
  ObjectClass label = ObjectClass::kUnknown;     ///< The most probable class.
  std::array<float, kClassCount> probability{};  ///< The probability of each class; the sum is 1.
  double existence = 0;                          ///< Probability, in [0, 1].
  double age_s = 0;                              ///< Time since the track began.
  bool is_measured = false;  ///< Whether this cycle had points of it; else it is predicted.
  uint32_t points = 0;       ///< Number of points in this cycle.
  OrientedBox box;           ///< The reported box: completed, if the stage completes boxes.
  Vec3 measured_size_m = Vec3::Zero();  ///< Extents of the points alone.
  Vec3 reference_m = Vec3::Zero();      ///< The reference point that is tracked.
  Vec3 velocity_m_s = Vec3::Zero();
  Vec3 acceleration_m_s2 = Vec3::Zero();
  double yaw_rate_rad_s = 0;
  Vec3 position_sigma_m = Vec3::Zero();  ///< Standard deviations, as OSI's `base_rmse` has them.
  double yaw_sigma_rad = 0;
  Vec3 size_sigma_m = Vec3::Zero();
  double speed_sigma_m_s = 0;
};

/// The objects at one time (IF3).
struct ObjectList {
  double time_s = 0;                   ///< The time that the objects' states describe.
  double available_s = 0;              ///< The time from which the list is available.
  Pose world_from_vehicle;             ///< The vehicle's pose at `time_s`.
  std::vector<TrackedObject> objects;  ///< In ascending order of id.
};

}  // namespace underbrush::perception
