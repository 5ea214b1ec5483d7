// Actors of a simulated drive: a box on wheels of air drives past a sensor over flat ground.
#include <gtest/gtest.h>

#include "drive_past.hpp"
#include "underbrush/actors/actor_beams.hpp"
#include "underbrush/pipeline/learn_actors.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::actors {
namespace {

using perception::SeenBox;

const Vec3 kSize(4.2, 1.8, 1.5);  // of the box, which stands 0.3 m above the ground
constexpr int kScans = 20;

/// A box without a floor, open below, with its origin in the middle of `kSize`.
elements::Model body() {
  elements::Model m;
  m.fitter = "test";
  const Vec3f h = (kSize / 2).cast<float>();
  for (const float x : {-h.x(), h.x()}) {
    for (const float y : {-h.y(), h.y()}) {
      for (const float z : {0.3f - h.z(), h.z()}) m.surface.vertices.emplace_back(x, y, z);
    }
  }
  m.surface.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5},
                         {0, 5, 1}, {2, 3, 7}, {2, 7, 6}, {1, 5, 7}, {1, 7, 3}};
  m.surface.hit.resize(m.surface.triangles.size());
  return m;
}

Pose pose_at(double t) {
  const double heading = 0.2 * t;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(heading, Vec3::UnitZ())),
          Vec3(-6 + 6 * t, 7 + 0.6 * t * t, kSize.z() / 2)};
}

/// The drive, in which the row `instance` says what is the car (1), and its true boxes.
struct Drive {
  BeamLog log;
  std::vector<SeenBox> boxes;
};

Drive simulated_drive() {
  pipeline::World world;
  world.scene.models.push_back(test::flat_ground(60));
  std::vector<StampedPose> poses;
  for (int k = 0; k <= 40; ++k) poses.push_back({0.05 * k, pose_at(0.05 * k)});
  pipeline::add_actors(world, {{"car-1", "car", body(), Trajectory(poses)}});
  const pipeline::TracedWorld traced(std::move(world));
  sensor::Sensor s = sensor::load("velodyne-vlp16");
  const Pose stands{Eigen::Quaterniond::Identity(), Vec3(0, 0, 1.8)};
  Drive out;
  out.log = sensor::beams(s, Trajectory({{0, stands}, {2, stands}}), 0, 2);
  pipeline::SimulateOptions options;
  options.element_ids = true;
  options.range_noise_m = 0.01;
  pipeline::Simulation(traced, options).answer(0, out.log);
  for (int k = 0; k < kScans; ++k) {
    const double t = 0.05 + 0.1 * k;
    const Pose pose = pose_at(t);
    SeenBox seen{uint32_t(k), t, {1, perception::ObjectClass::kCar, {}}};
    seen.object.box = {pose.translation, 0.2 * t, kSize};
    out.boxes.push_back(seen);
  }
  return out;
}

const Drive& drive() {
  static const Drive kDrive = simulated_drive();
  return kDrive;
}

bool is_car(const BeamLog& log, size_t i) {
  return std::get<std::vector<uint32_t>>(log.extra.at("instance"))[i] == 1;
}

/// Boxes with errors of 8 cm and 1.5°.
std::vector<SeenBox> jittered(std::vector<SeenBox> boxes) {
  Stream random(5);
  for (SeenBox& s : boxes) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      s.object.box.centre_m[axis] += 0.08 * random.normal();
    }
    s.object.box.yaw_rad += 0.026 * random.normal();
  }
  return boxes;
}

/// Root mean square distance of the views' origins from the true ones, m, without the mean error,
/// and of their headings, rad.
std::pair<double, double> errors_of(const std::vector<View>& views) {
  Vec3 mean = Vec3::Zero();
  double mean_turn = 0, off2 = 0, turn2 = 0;
  std::vector<std::pair<Vec3, double>> all;
  for (const View& v : views) {
    const Pose by = pose_at(v.time_s).inverse() * v.world_from_actor;
    all.emplace_back(by.translation, 2 * by.rotation.z());
    mean += by.translation / double(views.size());
    mean_turn += 2 * by.rotation.z() / double(views.size());
  }
  for (const auto& [off, turn] : all) {
    off2 += (off - mean).head<2>().squaredNorm() / double(all.size());
    turn2 += (turn - mean_turn) * (turn - mean_turn) / double(all.size());
  }
  return {std::sqrt(off2), std::sqrt(turn2)};
}

TEST(Actors, TheReturnsOfTheBoxesAreMarkedAndNoOthers) {
  Drive d = drive();
  d.boxes[0].object.label = perception::ObjectClass::kOther;
  const std::vector<Track> tracks = tracks_of(d.boxes);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].name(), "car-1");
  BoxesOfBeams boxes(tracks, {});
  const BeamLog met = beams_on(boxes, d.log);
  mark_returns(boxes, d.log);
  size_t car = 0, missed = 0, wrong = 0;
  for (size_t i = 0; i < d.log.size(); ++i) {
    const bool marked = (d.log.flags[i] & kMover) != 0;
    car += is_car(d.log, i);
    missed += is_car(d.log, i) && !marked;
    wrong += !is_car(d.log, i) && marked;
  }
  EXPECT_GT(car, 5000u);
  EXPECT_LT(missed, car / 100);
  EXPECT_EQ(wrong, 0u);
  size_t ended = 0;
  for (size_t i = 0; i < met.size(); ++i) ended += is_car(met, i);
  EXPECT_GT(ended, car - car / 100);
  EXPECT_GT(met.size(), ended + car / 20);
}

TEST(Actors, BoxesAreTakenFromListsOfObjects) {
  std::vector<perception::ObjectList> lists(3);
  for (size_t k = 0; k < lists.size(); ++k) {
    lists[k].time_s = 0.1 * double(k);
    lists[k].objects.resize(1);
    lists[k].objects[0].id = 4;
    lists[k].objects[0].box = {Vec3(double(k), 0, 0), k == 1 ? M_PI : 0.0, kSize};
  }
  const LogInfo& log = drive().log.info;
  const std::vector<Track> tracks = tracks_of(boxes_of(lists, log));
  ASSERT_EQ(tracks.size(), 1u);
  ASSERT_EQ(tracks[0].seen.size(), 3u);
  EXPECT_EQ(tracks[0].seen[2].scan, 2u);
  EXPECT_NEAR(std::cos(tracks[0].seen[1].object.box.yaw_rad), 1, 1e-12);
  lists[0].objects[0].is_measured = lists[2].objects[0].is_measured = true;
  EXPECT_EQ(boxes_of(lists, log).size(), 2u);
}

TEST(Actors, ViewsWithErrorsAreRegistered) {
  const Drive& d = drive();
  MemorySource source(d.log);
  std::vector<View> views = views_of(source, tracks_of(jittered(d.boxes)), {})[0];
  ASSERT_EQ(views.size(), size_t(kScans));
  const auto [off_m, turn_rad] = errors_of(views);
  const RegistrationReport report = register_views(views);
  const auto [left_m, left_rad] = errors_of(views);
  EXPECT_GT(off_m, 0.06);
  EXPECT_LT(left_m, 0.5 * off_m);
  EXPECT_LT(left_rad, 0.5 * turn_rad);
  EXPECT_LT(report.after_m, 0.5 * report.before_m);
}

/// The actor of the drive, learnt from boxes with errors.
LearntActors learnt_from(const BeamLog& log, const ActorOptions& options = {}) {
  MemorySource source(log);
  return pipeline::learn_actors(source, "log", tracks_of(jittered(drive().boxes)), options, 1);
}

const LearntActors& learnt_from_drive() {
  static const LearntActors kLearnt = learnt_from(drive().log);
  return kLearnt;
}

TEST(Actors, TheReplayOfALearntActorMeasuresWhatWasMeasured) {
  const Drive& d = drive();
  const LearntActors& learnt = learnt_from_drive();
  ASSERT_EQ(learnt.actors.size(), 1u);
  pipeline::World world;
  world.scene.models.push_back(test::flat_ground(60));
  pipeline::add_actors(world, learnt.actors);
  const pipeline::TracedWorld traced(std::move(world));
  BeamLog again = d.log;
  pipeline::Simulation(traced, {}).answer(0, again);
  size_t car = 0, near = 0, elsewhere = 0, ghosts = 0;
  for (size_t i = 0; i < d.log.size(); ++i) {
    if (!is_car(d.log, i)) {
      ++elsewhere;
      ghosts += again.is_hit(i) && std::abs(again.range_m[i] - d.log.range_m[i]) > 0.3;
      continue;
    }
    ++car;
    near += std::abs(again.range_m[i] - d.log.range_m[i]) < 0.15;
  }
  EXPECT_GT(double(near), 0.9 * double(car));
  // The car reaches half way to the next ring beyond its edges: its rings fall on each other in all
  // scans, so that nothing is known between them.
  EXPECT_LT(double(ghosts), 0.03 * double(car));
}

/// The share of beams across the actor's box, from its left side or from its right one, that meet
/// the actor within 0.15 m of that side.
double share_of_side(const elements::Model& model, double side) {
  BeamLog beams;
  beams.info.max_range_m = 50;
  beams.resize(2000);
  Stream random(3);
  for (size_t i = 0; i < beams.size(); ++i) {
    const double x = random.uniform(-1.8, 1.8);
    beams.origin[i] = Vec3(x, side * 10, random.uniform(-0.3, 0.6));
    beams.direction[i] = Vec3f(0, float(-side), 0);
  }
  pipeline::Simulation(pipeline::TracedWorld(model), {}).answer(0, beams);
  size_t near = 0;
  for (const float range : beams.range_m) {
    near += std::abs(double(range) - 10 + kSize.y() / 2) < 0.15;
  }
  return double(near) / double(beams.size());
}

TEST(Actors, MarksThatALogHasDoNotChangeWhatIsLearnt) {
  BeamLog marked = drive().log;
  for (size_t i = 0; i < marked.size(); ++i) marked.flags[i] |= is_car(marked, i) ? kMover : 0;
  const LearntActors again = learnt_from(marked);
  const auto& a = learnt_from_drive().actors[0].model.ellipsoids;
  const auto& b = again.actors[0].model.ellipsoids;
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k].mean, b[k].mean) << k;
}

TEST(Actors, TheUnseenSideIsThatOfTheMirror) {
  const LearntActors& whole = learnt_from_drive();
  ActorOptions options;
  options.one_sided = true;
  const LearntActors half = learnt_from(drive().log, options);
  EXPECT_GT(whole.report[0].mirrored, 0u);
  EXPECT_EQ(half.report[0].mirrored, 0u);
  EXPECT_LT(whole.actors[0].model.ellipsoids.size(), 2 * half.actors[0].model.ellipsoids.size());
  // The sensor stood on the right side of the car.
  const double right = share_of_side(half.actors[0].model, -1);
  EXPECT_GT(right, 0.8);
  EXPECT_LT(share_of_side(half.actors[0].model, 1), 0.1);
  EXPECT_NEAR(share_of_side(whole.actors[0].model, -1), right, 0.05);
  EXPECT_NEAR(share_of_side(whole.actors[0].model, 1), right, 0.05);
}

TEST(Actors, AWalkerIsRigidForAWhileOnly) {
  Drive d = drive();
  for (SeenBox& s : d.boxes) s.object.label = perception::ObjectClass::kPedestrian;
  MemorySource source(d.log);
  ActorOptions options;
  options.walk_s = 0.45;
  const FitActor fit = [](const BeamLog& beams) {
    elements::Model m = body();
    m.range_noise_m = double(beams.size());
    return m;
  };
  const LearntActors learnt = learn_actors(source, tracks_of(d.boxes), options, fit);
  ASSERT_EQ(learnt.actors.size(), 4u);
  EXPECT_EQ(learnt.report[0].models, 4u);
  EXPECT_EQ(learnt.report[0].mirrored, 0u);
  double beams = 0;
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(learnt.actors[k].name, "pedestrian-1");
    if (k > 0) {
      EXPECT_EQ(learnt.actors[k].from_s, learnt.actors[k - 1].to_s);
    }
    beams += learnt.actors[k].model.range_noise_m;
  }
  EXPECT_EQ(beams, double(learnt.report[0].returns + learnt.report[0].passed));
}

TEST(Actors, TracksAreFoundWithoutBoxes) {
  const Drive& d = drive();
  MemorySource source(d.log);
  const std::vector<Track> tracks = find_tracks(source, {});
  ASSERT_EQ(tracks.size(), 1u);
  BoxesOfBeams boxes(tracks, {});
  BeamLog log = d.log;
  mark_returns(boxes, log);
  size_t car = 0, marked = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    car += is_car(log, i);
    marked += is_car(log, i) && (log.flags[i] & kMover) != 0;
  }
  EXPECT_GT(double(marked), 0.7 * double(car));
}

}  // namespace
}  // namespace underbrush::actors
