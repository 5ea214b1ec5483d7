#include "underbrush/test_site/terrain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/drive.hpp"

namespace underbrush::test_site {
namespace {

constexpr uint64_t kTerrainSeed = 5;

TEST(Terrain, HasTheReliefAskedFor) {
  TerrainParameters p;
  p.size_x_m = p.size_y_m = 1000;
  p.slope = 0;
  const Terrain terrain(p, kTerrainSeed);
  double mean = 0, square = 0, steepest = 0;
  int n = 0;
  for (double x = -500; x <= 500; x += 7) {
    for (double y = 300; y <= 1300; y += 7, ++n) {
      const double z = terrain.height(x, y);
      mean += z;
      square += z * z;
      steepest = std::max(steepest, std::acos(terrain.normal(x, y).z()));
    }
  }
  EXPECT_NEAR(std::sqrt(square / n - mean * mean / n / n), p.relief_m, 0.15 * p.relief_m);
  EXPECT_GT(steepest, 0.15);  // slopes that vehicles can drive on
  EXPECT_LT(steepest, 0.75);  // no cliffs
}

TEST(Terrain, HasTheNormalOfItsMesh) {
  const Terrain terrain(TerrainParameters{}, kTerrainSeed);
  const elements::TriangleMesh mesh = terrain.mesh(0.25, 0);
  EXPECT_EQ(mesh.size(), size_t(2 * 240 * 160));
  double total = 0, worst = 0;
  for (size_t i = 0; i < mesh.size(); i += 13) {
    const auto& t = mesh.triangles[i];
    const Vec3 a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>();
    const Vec3 c = mesh.vertices[t[2]].cast<double>(), middle = (a + b + c) / 3;
    const Vec3 normal = (b - a).cross(c - a).normalized();
    total += normal.cross(terrain.normal(middle.x(), middle.y())).norm();
    worst = std::max(worst, std::abs(terrain.height(middle.x(), middle.y()) - middle.z()));
    EXPECT_GT(normal.z(), 0.7);
  }
  EXPECT_LT(total / double(mesh.size() / 13), 0.03);
  EXPECT_LT(worst, 0.03);
}

TEST(Track, DistanceIsThatOfTheNearestPoint) {
  const Terrain terrain(TerrainParameters{}, kTerrainSeed);
  Stream random(kTerrainSeed);
  for (int i = 0; i < 50; ++i) {
    const double x = random.uniform(-30, 30), y = terrain.track_y(x) + random.uniform(-8, 8);
    double nearest = 1e9;
    for (double u = x - 12; u < x + 12; u += 0.01) {
      nearest = std::min(nearest, std::hypot(u - x, terrain.track_y(u) - y));
    }
    EXPECT_NEAR(terrain.distance_to_track(x, y), nearest, 0.01);
  }
}

TEST(Drive, FollowsTheTrackAndTheGround) {
  const Terrain terrain(TerrainParameters{}, kTerrainSeed);
  const DriveParameters p;
  const Trajectory trajectory = drive(terrain, p);
  const auto& poses = trajectory.poses();
  ASSERT_GT(poses.size(), 200u);
  double tilt = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i].world_from_sensor;
    const Mat3 axes = pose.rotation.toRotationMatrix();
    const Vec3 foot = pose.translation - p.sensor_height_m * axes.col(2);
    EXPECT_NEAR(foot.z(), terrain.height(foot.x(), foot.y()), 0.08);
    EXPECT_LT(terrain.distance_to_track(foot.x(), foot.y()), 0.03);
    EXPECT_GT(axes.col(2).dot(terrain.normal(foot.x(), foot.y())), std::cos(0.12));
    tilt = std::max(tilt, std::acos(axes(2, 2)));
    if (i == 0) continue;
    const Vec3 step = pose.translation - poses[i - 1].world_from_sensor.translation;
    const double speed = step.norm() / (poses[i].time_s - poses[i - 1].time_s);
    EXPECT_GT(speed, 2.0);
    EXPECT_LT(speed, 5.2);
    EXPECT_GT(step.normalized().dot(axes.col(0)), 0.99);
  }
  EXPECT_GT(tilt, 0.05);
}

}  // namespace
}  // namespace underbrush::test_site
