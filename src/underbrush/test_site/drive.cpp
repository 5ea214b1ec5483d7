#include "underbrush/test_site/drive.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::test_site {
namespace {

Pose sensor_pose(const Terrain& terrain, const DriveParameters& p, double x) {
  const double heading = std::atan(terrain.track_slope(x));
  const Eigen::Vector2d at(x, terrain.track_y(x));
  const Eigen::Vector2d ahead =
      0.5 * p.wheelbase_m * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  const Eigen::Vector2d left =
      0.5 * p.track_width_m * Eigen::Vector2d(-std::sin(heading), std::cos(heading));
  const auto wheel = [&](double f, double l) {
    const Eigen::Vector2d w = at + f * ahead + l * left;
    return Vec3(w.x(), w.y(), terrain.height(w.x(), w.y()));
  };
  const Vec3 fl = wheel(1, 1), fr = wheel(1, -1), rl = wheel(-1, 1), rr = wheel(-1, -1);
  const Vec3 forward = (fl + fr - rl - rr).normalized();
  const Vec3 up = forward.cross(fl + rl - fr - rr).normalized();
  Mat3 axes;
  axes << forward, up.cross(forward), up;
  return {Eigen::Quaterniond(axes).normalized(),
          0.25 * (fl + fr + rl + rr) + p.sensor_height_m * up};
}

}  // namespace

Trajectory drive(const Terrain& terrain, const DriveParameters& p) {
  const double end_m = 0.5 * terrain.parameters().size_x_m - p.margin_m;
  require(
      p.speed_m_s > 0 && p.poses_per_s > 0 && p.wheelbase_m > 0 && p.track_width_m > 0 && end_m > 0,
      "drive: impossible size");
  const double dt = 1 / p.poses_per_s;
  std::vector<StampedPose> poses;
  for (double x = -end_m; x <= end_m;) {
    const double time_s = double(poses.size()) * dt;
    poses.push_back({time_s, sensor_pose(terrain, p, x)});
    const double step_m = dt * p.speed_m_s * (1 + 0.35 * std::sin(2 * M_PI * time_s / 7));
    const double middle = x + 0.5 * step_m / std::hypot(1, terrain.track_slope(x));
    x += step_m / std::hypot(1, terrain.track_slope(middle));
  }
  return Trajectory(std::move(poses));
}

}  // namespace underbrush::test_site
