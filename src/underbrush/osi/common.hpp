/// \file
/// This file has the small parts that all messages of the Open Simulation Interface share.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Messages of the Open Simulation Interface (OSI 3.5 to 3.8): reading, writing, traces, conversion
/// to logs and object lists, and the chain from reflections to objects.
namespace osi {

/// The version of OSI that messages are written in.
struct Version {
  uint32_t major = 3, minor = 8, patch = 0;
  bool operator==(const Version&) const = default;
};

/// A time, as OSI counts it.
struct Timestamp {
  int64_t seconds = 0;
  uint32_t nanos = 0;  ///< Below 10⁹.

  double s() const { return double(seconds) + 1e-9 * double(nanos); }
  /// Rounds to whole nanoseconds. Throws `std::invalid_argument` for a time that is not finite or
  /// more than 10¹² s.
  static Timestamp of(double time_s);
  auto operator<=>(const Timestamp&) const = default;
};

/// The number of an object that stands for none (the largest value of OSI's identifiers).
inline constexpr uint64_t kNoId = UINT64_MAX;

/// A rotation by yaw, then pitch, then roll, in the order of OSI: R = Rz(z) Ry(y) Rx(x). The vector
/// holds roll, pitch and yaw (rad).
Eigen::Quaterniond rotation_of(const Vec3& roll_pitch_yaw);
/// The inverse of `rotation_of`; the pitch is in [−π/2, π/2].
Vec3 roll_pitch_yaw_of(const Eigen::Quaterniond& rotation);

/// The place of a sensor on a vehicle, whose frame has its origin in the middle of the rear axle, x
/// forward, y left and z up.
struct Mounting {
  std::optional<Vec3> position_m, roll_pitch_yaw;
  Pose pose() const;
  static Mounting of(const Pose& vehicle_from_sensor);
};

/// The place, size and motion of an object. Each value may be absent.
struct BaseMoving {
  std::optional<Vec3> dimension_m;  ///< Length, width, height.
  std::optional<Vec3> position_m;   ///< Centre of the box.
  std::optional<Vec3> roll_pitch_yaw;
  std::optional<Vec3> velocity_m_s, acceleration_m_s2;
  std::optional<Vec3> turn_rate_rad_s;  ///< Rates of roll, pitch and yaw.

  /// The pose of the box; absent values count as zero.
  Pose pose() const;
};

/// The numbers of `MovingObject.Type`.
enum class ObjectType : uint32_t { kUnknown, kOther, kVehicle, kPedestrian, kAnimal };
/// The numbers of `MovingObject.VehicleClassification.Type` that the program writes or
/// distinguishes.
enum class VehicleType : uint32_t {
  kUnknown = 0,
  kOther = 1,
  kSmallCar = 2,
  kCompactCar = 3,
  kMediumCar = 4,
  kLuxuryCar = 5,
  kDeliveryVan = 6,
  kHeavyTruck = 7,
  kSemitrailer = 8,
  kTrailer = 9,
  kMotorbike = 10,
  kBicycle = 11,
  kBus = 12,
  kTram = 13,
  kTrain = 14,
  kWheelchair = 15,
  kSemitractor = 16,
  kStandupScooter = 17,
  kMicromobility = 18,
  kLandVehicle = 22
};

/// The numbers of `DataQualifier` in the headers of detections and of objects.
enum class DataQualifier : uint32_t { kUnknown, kOther, kAvailable, kReduced, kNotAvailable };

}  // namespace osi
}  // namespace underbrush
