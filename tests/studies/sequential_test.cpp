#include "studies/sequential.hpp"

#include <gtest/gtest.h>

#include "studies/moving_objects.hpp"
#include "studies/studies.hpp"

namespace underbrush::studies {
namespace {

using perception::ObjectList;

TEST(Intersection, TheTurningCarIsHiddenForMoreThanTenCycles) {
  const Intersection scene = make_intersection();
  const BeamLog log = scan_intersection(scene, 0, 0, 1);
  const perception::LogTruth truth(scene.truth);
  perception::PerceptionSetup setup = measured_setup(true);
  setup.rig = scene.rig;
  MemorySource source(log);
  const perception::PerceivedLog made = perception::perceived(source, &truth, setup);
  EXPECT_EQ(made.lists.size(), 96u) << "7.62 s at 12.5 Hz";
  const Absence away = absence_of(made.lists, made.truth, kTurningCar);
  EXPECT_GT(away.lost, 20);
  EXPECT_GT(away.found, away.lost + 3);
  const Absence standing = absence_of(made.lists, made.truth, kStandingCar);
  EXPECT_EQ(standing.lost, -1);
}

TEST(NoisyTruth, HasTheErrorsOfTheRealLists) {
  std::vector<ObjectList> truth, real;
  for (int k = 0; k < 4000; ++k) {
    perception::TruthFrame frame{
        0.1 * k, {{1, perception::ObjectClass::kCar, {{10, 5, 1}, 0, {4, 2, 1.5}}}}};
    truth.push_back(perception::list_of_truth(frame, {}));
    real.push_back(truth.back());
    real.back().objects[0].box.size_m.x() -= 0.5;
    real.back().objects[0].box.centre_m.y() += 0.2;
  }
  const auto noisy = noisy_truth(truth, real, 3);
  double length = 0, x = 0, y = 0;
  for (size_t k = 0; k < truth.size(); ++k) {
    const auto d = noisy[k].objects[0].box.centre_m - truth[k].objects[0].box.centre_m;
    length += std::pow(noisy[k].objects[0].box.size_m.x() - 4, 2);
    x += d.x() * d.x();
    y += d.y() * d.y();
  }
  const double n = double(truth.size());
  EXPECT_NEAR(std::sqrt(length / n), 0.5, 0.02);
  EXPECT_NEAR(std::sqrt(y / n), 0.2, 0.01);
  EXPECT_EQ(x, 0);
}

TEST(ListChecks, ATruthThatIsBestFailsThem) {
  perception::ComparedObject o;
  o.simulated_real.cycles = o.simulated_truth.cycles = o.real_truth.cycles = 50;
  o.simulated_real.rmse_m.fill(0.2);
  o.real_truth.rmse_m.fill(1);
  perception::ComparedObject noise = o;
  noise.simulated_real.rmse_m.fill(0.5);
  for (const Check& c : list_checks("good", {o}, {noise})) EXPECT_TRUE(c.holds()) << c.what;
  for (const Check& c : list_checks("bad", {noise}, {o})) {
    EXPECT_EQ(c.holds(), c.limit == 0.5 && c.value <= 0.5) << c.what;
  }
  EXPECT_FALSE(list_checks("none", {}, {noise})[0].holds()) << "no object is no success";
}

TEST(MovingObjects, AreAwayBeforeAndAfterTheirLabels) {
  ObjectTrack track;
  track.id = 1;
  track.label = perception::ObjectClass::kVan;
  track.size_m = {4, 2, 2};
  for (int k = 0; k < 3; ++k) {
    track.seen.push_back(
        {uint32_t(k), 1 + 0.1 * k, {1, track.label, {{10.0 + k, 0, 1}, 0, track.size_m}}});
  }
  pipeline::World world;
  world.scene.models.emplace_back();
  add_objects(world, {track}, meshes_of({track}));
  ASSERT_EQ(world.info.movers.size(), 1u);
  const Trajectory& path = world.info.movers[0].world_from_object;
  EXPECT_LT(path.poses().front().world_from_sensor.translation.z(), -100);
  EXPECT_LT(path.poses().back().world_from_sensor.translation.z(), -100);
  EXPECT_NEAR(path.at(1.05)->translation.x(), 10.5, 1e-9);
  EXPECT_NEAR(path.at(1.05)->translation.z(), 1, 1e-9);
}

}  // namespace
}  // namespace underbrush::studies
