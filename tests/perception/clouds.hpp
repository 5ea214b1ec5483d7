/// \file
/// Clouds of boxes for the tests of perception.
#pragma once
#include <cmath>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/perception/cloud.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::perception::test {

/// An empty cloud of a vehicle that stands at the origin, with one sensor 1 m above it.
inline MergedCloud empty_cloud(double time_s) {
  MergedCloud cloud;
  cloud.time_s = cloud.available_s = time_s;
  cloud.sensor_m = {Vec3f(0, 0, 1)};
  return cloud;
}

/// Adds a point, given in the vehicle's frame.
inline void add_point(MergedCloud& cloud, const Vec3& point) {
  cloud.point_m.push_back(point.cast<float>());
  cloud.stamp_s.push_back(cloud.time_s);
  cloud.intensity.push_back(1);
  cloud.ring.push_back(0);
  cloud.sensor.push_back(0);
}

/// The points on the sides of a box that face a viewpoint, `step_m` apart, from 0.3 m above the
/// bottom to the top.
inline std::vector<Vec3> seen_sides(const OrientedBox& box, const Vec3& viewpoint,
                                    double step_m = 0.1) {
  std::vector<Vec3> points;
  const Vec3 view = box.to_box(viewpoint), half = box.size_m / 2;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(view[axis]) <= half[axis]) continue;
    const int other = 1 - axis;
    const int n = int(std::floor(box.size_m[other] / step_m));
    for (double z = -half.z() + 0.3; z <= half.z() + 1e-9; z += step_m) {
      for (int k = 0; k <= n; ++k) {
        Vec3 p(0, 0, z);
        p[axis] = view[axis] > 0 ? half[axis] : -half[axis];
        p[other] = -half[other] + box.size_m[other] * k / n;
        points.push_back(box.from_box(p));
      }
    }
  }
  return points;
}

/// Adds what the sensor of `empty_cloud` sees of a box, with noise on every coordinate.
inline void add_box(MergedCloud& cloud, const OrientedBox& box, double step_m = 0.1,
                    double sigma_m = 0, uint64_t seed = 1) {
  Stream random(seed);
  const Pose from_world = cloud.world_from_vehicle.inverse();
  const Vec3 viewpoint = cloud.world_from_vehicle * Vec3(0, 0, 1);
  for (const Vec3& p : seen_sides(box, viewpoint, step_m)) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    add_point(cloud, from_world * Vec3(p + sigma_m * Vec3(x, y, z)));
  }
}

/// Adds flat ground around the vehicle.
inline void add_ground(MergedCloud& cloud, double reach_m = 30, double step_m = 0.5) {
  for (double x = -reach_m; x <= reach_m; x += step_m) {
    for (double y = -reach_m; y <= reach_m; y += step_m) add_point(cloud, {x, y, 0});
  }
}

}  // namespace underbrush::perception::test
