#include "studies/sequential.hpp"

#include <gtest/gtest.h>

#include "drive_past.hpp"
#include "studies/chain_lists.hpp"
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

// A van drives away from a lidar that stands 1 m above the ground; it comes in the third scan.
TEST(ChainLists, FollowTheObjectsOfTheTruthAndOfTheWorld) {
  constexpr int kScans = 16;
  const Vec3 size(5, 2, 2);
  LogInfo log;
  log.sensor = "ibeo-lux-2010";
  std::vector<ObjectList> lists;
  for (int k = 0; k < kScans; ++k) {
    log.scans.push_back({uint32_t(k), 0.08 * k, {}});
    perception::TruthFrame frame{0.08 * k, {}};
    if (k >= 2) {
      frame.objects = {{7, perception::ObjectClass::kVan, {{14 + 0.2 * k, 1, 0}, 0, size}}};
    }
    lists.push_back(perception::list_of_truth(frame, {}));
  }
  actors::Track track;
  track.id = 7;
  track.label = perception::ObjectClass::kVan;
  track.size_m = size;
  const ChainWorld world{test::flat_ground(60, {0, 0, -1}), {track}, meshes_of({track})};
  const perception::LogTruth truth(lists);
  const ChainLists made =
      chain_lists(log, truth, world, {{"as_measured", "true"}, {"axle_height_m", "0"}}, 1);
  for (const auto* found : {&made.model, &made.pipeline}) {
    ASSERT_EQ(found->size(), size_t(kScans));
    EXPECT_TRUE((*found)[3].objects.empty()) << "two cycles do not confirm it";
    const ObjectList& last = found->back();
    ASSERT_EQ(last.objects.size(), 1u);
    const auto& box = last.objects[0].box;
    EXPECT_NEAR(box.centre_m.x() - box.size_m.x() / 2, 14 + 0.2 * (kScans - 1) - 2.5, 0.2);
    EXPECT_NEAR(box.centre_m.y(), 1, 0.15);
    EXPECT_NEAR(box.size_m.y(), 2, 0.3);
  }
  EXPECT_EQ(made.model.back().objects[0].truth_id, 7u);
  EXPECT_EQ(made.pipeline.back().objects[0].truth_id, 0u);
}

}  // namespace
}  // namespace underbrush::studies
