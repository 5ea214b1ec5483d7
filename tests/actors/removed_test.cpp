// What stands behind an actor that is taken away: a screen that moves in front of a wall.
#include <gtest/gtest.h>

#include "drive_past.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/support.hpp"

namespace underbrush::actors {
namespace {

constexpr double kScreen = 7, kWall = 14;  // m, y of the screen and of the wall
constexpr double kHalf = 3, kWay = 2;      // m, half the width of the screen, and how far it goes
const Vec3 kSensor(0, 0, 1.8);

/// A sheet across y, from x = −half to half and from z = 0 to `high`.
elements::TriangleMesh sheet(float half, float y, float high) {
  elements::TriangleMesh out;
  out.vertices = {{-half, y, 0}, {half, y, 0}, {half, y, high}, {-half, y, high}};
  out.triangles = {{0, 1, 2}, {0, 2, 3}};
  out.hit.resize(2);
  out.range_sigma_m = 0.01F;
  return out;
}

/// The log of a sensor that stands still; returns of the screen are marked.
BeamLog recorded() {
  pipeline::World world;
  world.scene.models.push_back(test::flat_ground(40));
  world.scene.models[0].surface = sheet(30, float(kWall), 8);
  elements::Model screen;
  screen.fitter = "test";
  screen.surface = sheet(float(kHalf), 0, 3);
  const auto at = [](double x) {
    return Pose{Eigen::Quaterniond::Identity(), Vec3(x, kScreen, 0)};
  };
  pipeline::add_actors(world,
                       {{"screen", "other", screen, Trajectory({{0, at(-kWay)}, {2, at(kWay)}})}});
  const pipeline::TracedWorld traced(std::move(world));
  const Pose stands{Eigen::Quaterniond::Identity(), kSensor};
  BeamLog log =
      sensor::beams(sensor::load("velodyne-vlp16"), Trajectory({{0, stands}, {2, stands}}), 0, 2);
  pipeline::SimulateOptions options;
  options.element_ids = true;
  pipeline::Simulation(traced, options).answer(0, log);
  const auto& instance = std::get<std::vector<uint32_t>>(log.extra.at("instance"));
  for (size_t i = 0; i < log.size(); ++i) log.flags[i] |= instance[i] == 1 ? kMover : 0;
  log.extra.clear();
  return log;
}

TEST(RemovedActor, LeavesTheWallThatOtherScansSawAndUnknownSpaceElsewhere) {
  const BeamLog log = recorded();
  MemorySource source(log);
  const elements::Model world = pipeline::fit_model({source}, {}).model;
  BeamLog behind = log.like();
  for (size_t i = 0; i < log.size(); ++i) {
    if ((log.flags[i] & kMover) != 0) behind.append(log, i);
  }
  ASSERT_GT(behind.size(), 10000u);
  pipeline::SimulateOptions options;
  options.support = true;
  const BeamLog again = pipeline::simulate_log(world, behind, options);
  const auto& support = std::get<std::vector<float>>(again.extra.at(simulate::kSupportColumn));
  constexpr float kKnown = 0.9F;  // as scores by support have it
  size_t seen = 0, right = 0, known = 0, hidden = 0, unknown = 0;
  for (size_t i = 0; i < behind.size(); ++i) {
    const Vec3 d = behind.direction[i].cast<double>();
    const double wall_m = kWall / d.y();
    const double elevation_rad = std::asin(d.z());
    const double truth_m = d.z() < 0 ? std::min(wall_m, -kSensor.z() / d.z()) : wall_m;
    // The screen hides what lies within kHalf of its middle, which goes from −kWay to kWay.
    const double across = std::abs(kScreen * d.x() / d.y());
    if (across > kHalf - kWay + 0.3) {
      ++seen;
      right += again.is_hit(i) && std::abs(double(again.range_m[i]) - truth_m) < 0.2;
      known += support[i] >= kKnown;
    } else if (across < kHalf - kWay - 0.3 && elevation_rad > -0.1 && elevation_rad < 0.125) {
      // The ground is known from both sides, and what is less than a cell below the upper edge.
      ++hidden;
      unknown += support[i] < kKnown;
    }
  }
  EXPECT_GT(double(right), 0.95 * double(seen));
  EXPECT_GT(double(known), 0.95 * double(seen));
  EXPECT_GT(double(unknown), 0.95 * double(hidden));
}

}  // namespace
}  // namespace underbrush::actors
