#include "underbrush/pipeline/out_of_reach.hpp"

#include <gtest/gtest.h>

namespace underbrush::pipeline {
namespace {

using metrics::Bounds;

const Bounds kWorld{{0, 0, 100}, {40, 30, 120}};
const std::string kPlaces = "no beam meets anything: the sensor lies at ",
                  kIn = ", the world at x 0.0 to 40.0, y 0.0 to 30.0, z 100.0 to 120.0 m; ";

Bounds at(const Vec3& low, const Vec3& high) { return {low, high}; }

TEST(OutOfReach, AboveBelowAndBeside) {
  EXPECT_EQ(why_nothing_is_hit(at({10, 10, 2120}, {20, 10.01, 2130}), kWorld, 300),
            kPlaces + "x 10.0 to 20.0, y 10.0, z 2120.0 to 2130.0 m" + kIn +
                "it is 2 km above the world, beyond its range of 300 m");
  EXPECT_EQ(why_nothing_is_hit(at({10, 10, -900}, {10, 10, -900}), kWorld, 120),
            kPlaces + "x 10.0, y 10.0, z -900.0 m" + kIn +
                "it is 1 km below the world, beyond its range of 120 m");
  EXPECT_EQ(why_nothing_is_hit(at({340, 430, 220}, {340, 430, 220}), kWorld, 120),
            kPlaces + "x 340.0, y 430.0, z 220.0 m" + kIn +
                "it is 100 m above and 500 m beside the world, beyond its range of 120 m");
}

TEST(OutOfReach, OtherCoordinatesAndDirections) {
  const Bounds utm = at({412300, 5645600, 110}, {412300, 5645600, 110});
  const std::string other = other_coordinates(utm, kWorld);
  EXPECT_NE(other.find("they are 5661 km apart, so one of them has coordinates of another system"),
            std::string::npos)
      << other;
  EXPECT_EQ(why_nothing_is_hit(utm, kWorld, 1e9), "no beam meets anything: " + other);
  const Bounds near = at({10, 10, 200}, {10, 10, 200});
  EXPECT_EQ(other_coordinates(near, kWorld), "");
  EXPECT_NE(why_nothing_is_hit(near, kWorld, 120).find("its beams point past the world"),
            std::string::npos);
  EXPECT_EQ(why_nothing_is_hit(near, Bounds(), 120), "no beam meets anything: the world is empty");
}

TEST(OutOfReach, GroundInOtherCoordinatesThanTheRest) {
  elements::Model ground, wall;
  ground.ground.vertices = wall.surface.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  ground.ground.triangles = wall.surface.triangles = {{0, 1, 2}};
  elements::Scene scene;
  scene.models = {ground, wall};
  scene.instances.resize(2);
  scene.instances[1].model = 1;
  const Bounds sensor = at({5, 5, 2}, {5, 5, 2});
  EXPECT_EQ(ground_elsewhere(sensor, scene), "");
  scene.instances[0].world_from_model.translation = {412300, 5645600, 110};
  EXPECT_NE(ground_elsewhere(sensor, scene).find("no beam reaches the ground: the sensor lies at"),
            std::string::npos);
  scene.instances[1].model = 0;  // Some ground is near.
  EXPECT_EQ(ground_elsewhere(sensor, scene), "");
}

TEST(OutOfReach, WorldsInMillimetresAreLarge) {
  const auto world = [](double width, double height) {
    Bounds box;
    box.add(Vec3(0, 0, 0));
    box.add(Vec3(width, width / 2, height));
    return larger_than_life(box);
  };
  EXPECT_NE(world(10000, 4000).find("--unit 0.001"), std::string::npos);  // a room
  EXPECT_NE(world(5000, 15000), "");                                      // a tree
  EXPECT_EQ(world(10, 4), "");
  EXPECT_EQ(world(5000, 1200), "");  // mountains
  EXPECT_EQ(larger_than_life(Bounds()), "");
}

TEST(OutOfReach, WorldsWhoseYAxisPointsUpLieOnTheirSide) {
  const auto world = [](double x, double y, double z) {
    Bounds box;
    box.add(Vec3(0, 0, 0));
    box.add(Vec3(x, y, z));
    return box;
  };
  EXPECT_NE(larger_than_life(world(200, 20, 200)).find("--up y"), std::string::npos);
  EXPECT_NE(larger_than_life(world(800, 6, 800)).find("--up y"), std::string::npos);
  EXPECT_EQ(larger_than_life(world(200, 200, 20)), "");
  EXPECT_EQ(larger_than_life(world(200, 30, 20)), "");  // a road
  EXPECT_EQ(larger_than_life(world(100, 1, 20)), "");   // a front of a house
  const Bounds sensor = at({5, 10, 1}, {5, 10, 1});
  EXPECT_NE(why_nothing_is_hit(sensor, world(200, 20, 200), 100).find("--up y"), std::string::npos);
}

TEST(OutOfReach, TrajectoriesInOtherUnitsAndOrders) {
  const auto warned = [](double step_m, const Eigen::Quaterniond& turn) {
    std::vector<StampedPose> poses(5);
    for (int k = 0; k < 5; ++k) {
      poses[size_t(k)].time_s = 0.1 * k;
      poses[size_t(k)].world_from_sensor = {turn, Vec3(step_m * k, 0, 0)};
    }
    const std::vector<std::string> found = warnings_of_path(Trajectory(poses));
    return found.empty() ? "" : found.at(0);
  };
  const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
  EXPECT_NE(warned(1500, upright).find("15000 m/s"), std::string::npos);
  EXPECT_EQ(warned(25, upright), "") << "an aircraft";
  EXPECT_NE(warned(1, Eigen::Quaterniond(0, 1, 0, 0)).find("qw qx qy qz?"), std::string::npos);
  EXPECT_EQ(warned(1, Eigen::Quaterniond(std::sqrt(0.5), 0, std::sqrt(0.5), 0)), "")
      << "on its side";
  EXPECT_TRUE(warnings_of_path(Trajectory()).empty());
}

}  // namespace
}  // namespace underbrush::pipeline
