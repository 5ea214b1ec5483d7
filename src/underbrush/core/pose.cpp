#include "underbrush/core/pose.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush {

Pose interpolate(const Pose& a, const Pose& b, double s) {
  const Eigen::AngleAxisd turn(a.rotation.conjugate() * b.rotation);
  double angle = turn.angle();
  if (angle > M_PI) angle -= 2 * M_PI;
  const Eigen::Quaterniond part(Eigen::AngleAxisd(s * angle, turn.axis()));
  return {(a.rotation * part).normalized(), a.translation + s * (b.translation - a.translation)};
}

Trajectory::Trajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  for (const StampedPose& p : poses_) {
    require(std::isfinite(p.time_s) && p.world_from_sensor.translation.allFinite() &&
                p.world_from_sensor.rotation.coeffs().allFinite(),
            "trajectory: a pose is not finite");
  }
  std::stable_sort(poses_.begin(), poses_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time_s < b.time_s; });
  for (size_t i = 1; i < poses_.size(); ++i) {
    require(poses_[i - 1].time_s < poses_[i].time_s, "trajectory: two poses share one time");
  }
}

std::optional<Pose> Trajectory::at(double time_s) const {
  if (poses_.empty() || !std::isfinite(time_s)) return std::nullopt;
  if (poses_.size() == 1) return poses_.front().world_from_sensor;
  const auto after = std::upper_bound(poses_.begin() + 1, poses_.end() - 1, time_s,
                                      [](double t, const StampedPose& p) { return t < p.time_s; });
  const StampedPose& b = *after;
  const StampedPose& a = *(after - 1);
  const double s = (time_s - a.time_s) / (b.time_s - a.time_s);
  if (s < -kMaxExtrapolation || s > 1 + kMaxExtrapolation) return std::nullopt;
  return interpolate(a.world_from_sensor, b.world_from_sensor, s);
}

}  // namespace underbrush
