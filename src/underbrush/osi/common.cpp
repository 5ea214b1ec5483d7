#include "underbrush/osi/common.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::osi {

Timestamp Timestamp::of(double time_s) {
  require(std::abs(time_s) <= 1e12, "osi: a time is not finite or too large");
  const double whole = std::floor(time_s);
  Timestamp t{int64_t(whole), 0};
  const auto nanos = uint64_t(std::llround((time_s - whole) * 1e9));
  t.seconds += int64_t(nanos / 1'000'000'000);
  t.nanos = uint32_t(nanos % 1'000'000'000);
  return t;
}

Eigen::Quaterniond rotation_of(const Vec3& a) {
  return Eigen::AngleAxisd(a.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(a.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(a.x(), Vec3::UnitX());
}

Vec3 roll_pitch_yaw_of(const Eigen::Quaterniond& rotation) {
  const Mat3 r = rotation.toRotationMatrix();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2)));
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

Pose Mounting::pose() const {
  return {rotation_of(roll_pitch_yaw.value_or(Vec3::Zero())), position_m.value_or(Vec3::Zero())};
}

Mounting Mounting::of(const Pose& p) { return {p.translation, roll_pitch_yaw_of(p.rotation)}; }

Pose BaseMoving::pose() const {
  return {rotation_of(roll_pitch_yaw.value_or(Vec3::Zero())), position_m.value_or(Vec3::Zero())};
}

}  // namespace underbrush::osi
