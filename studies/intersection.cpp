#include "studies/intersection.hpp"

#include <algorithm>
#include <cmath>

#include "studies/car_mesh.hpp"
#include "underbrush/perception/rig_source.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace {

using perception::ObjectClass;
using perception::OrientedBox;

constexpr double kTruthStepS = 0.02;
const Vec3 kCarSize(4.6, 1.8, 1.5);

Pose placed(double x, double y, double z, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), {x, y, z}};
}

// The own car brakes from 5 m/s with 1.25 m/s² and stands after 4 s and 10 m.
double driven_m(double t) {
  const double braking = std::min(t, 4.0);
  return 5 * braking - 1.25 * braking * braking / 2;
}

OrientedBox standing() { return {{22, 0, 0.75}, M_PI / 2, kCarSize}; }

// The third car drives at 3 m/s along y, 7 m behind the standing one, and then turns left.
OrientedBox turning(double t) {
  constexpr double kRadius = 8, kStraight = 15;
  const double s = 3 * t;
  if (s <= kStraight) return {{29, -12 + s, 0.75}, M_PI / 2, kCarSize};
  const double angle = (s - kStraight) / kRadius;
  return {{29 - kRadius * (1 - std::cos(angle)), 3 + kRadius * std::sin(angle), 0.75},
          perception::wrapped(M_PI / 2 + angle),
          kCarSize};
}

elements::Model flat_ground() {
  elements::Model ground;
  ground.fitter = "mesh";
  ground.ground.vertices = {{-50, -100, 0}, {150, -100, 0}, {150, 100, 0}, {-50, 100, 0}};
  ground.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  ground.ground.hit.assign(2, {});
  return ground;
}

}  // namespace

Intersection make_intersection() {
  Intersection scene;
  const auto mounted = [](const char* name, double y, double yaw) {
    return perception::MountedSensor{name, "ibeo-lux-2010", placed(3.7, y, 0.5, yaw), 0.04, 0};
  };
  const double yaw = 25 * M_PI / 180;
  scene.rig = {"two-ibeo-lux-2010", {mounted("left", 0.75, yaw), mounted("right", -0.75, -yaw)}};
  std::vector<StampedPose> poses;
  for (double t = 0; t <= kIntersectionS + 0.1; t += kTruthStepS) {
    poses.push_back({t, placed(driven_m(t), 0, 0, 0)});
    if (t > kIntersectionS) break;
    perception::TruthFrame frame{t,
                                 {{kStandingCar, ObjectClass::kCar, standing()},
                                  {kTurningCar, ObjectClass::kCar, turning(t)}}};
    scene.truth.push_back(perception::list_of_truth(frame, poses.back().world_from_sensor));
  }
  poses.back().time_s = kIntersectionS;
  poses.back().world_from_sensor = placed(driven_m(kIntersectionS), 0, 0, 0);
  scene.world_from_vehicle = Trajectory(poses);
  return scene;
}

BeamLog scan_intersection(const Intersection& scene, int columns, int rows, uint64_t seed) {
  pipeline::World world;
  world.scene.models.push_back(flat_ground());
  std::vector<StampedPose> still, moving;
  for (const auto& list : scene.truth) {
    const auto pose = [](const OrientedBox& b) {
      return placed(b.centre_m.x(), b.centre_m.y(), b.centre_m.z(), b.yaw_rad);
    };
    still.push_back({list.time_s, pose(list.objects[0].box)});
    moving.push_back({list.time_s, pose(list.objects[1].box)});
  }
  const elements::Model car = road_user(ObjectClass::kCar, kCarSize);
  pipeline::add_mover(world, car, Trajectory(still), "");
  pipeline::add_mover(world, car, Trajectory(moving), "");
  const pipeline::TracedWorld traced(std::move(world));
  pipeline::SimulateOptions options;
  options.seed = seed;
  if (columns > 0) {
    options.instrument.super_sample = std::to_string(columns) + "x" + std::to_string(rows);
  }
  perception::RigSource beams(scene.rig, scene.world_from_vehicle);
  pipeline::Simulation simulation(traced, options, beams.sensors());
  return pipeline::simulate_log(simulation, beams);
}

}  // namespace underbrush::studies
