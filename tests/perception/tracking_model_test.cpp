#include "underbrush/perception/tracking_model.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"
#include "underbrush/perception/output_delay.hpp"

namespace underbrush::perception {
namespace {

constexpr double kStep = 0.08;

TruthObject car(uint64_t id, const Vec3& centre, double yaw) {
  return {id, ObjectClass::kCar, {centre, yaw, {4.6, 1.8, 1.5}}};
}

MergedCloud cloud_of(const std::vector<TruthObject>& objects, double time_s, double step_m = 0.15) {
  MergedCloud cloud = test::empty_cloud(time_s);
  for (const auto& o : objects) test::add_box(cloud, o.box, step_m);
  return cloud;
}

TEST(TrackingModel, ConfirmsInTheThirdCycleCoastsNineAndDropsInTheTenth) {
  TrackingModel model;
  ObjectList list;
  const std::vector<TruthObject> objects{car(7, {15, 2, 0.75}, 0)};
  int cycle = 0;
  const auto step = [&](bool visible) {
    const double t = kStep * cycle++;
    model.step(visible ? cloud_of(objects, t) : test::empty_cloud(t), {t, objects}, list);
    return list.objects.size();
  };
  EXPECT_EQ(step(true), 0u);
  EXPECT_EQ(step(true), 0u);
  EXPECT_EQ(step(true), 1u);
  EXPECT_EQ(list.objects[0].truth_id, 7u);
  EXPECT_EQ(list.objects[0].label, ObjectClass::kCar);
  EXPECT_TRUE(list.objects[0].is_measured);
  const uint64_t id = list.objects[0].id;
  for (int k = 0; k < 5; ++k) step(true);
  EXPECT_EQ(list.objects[0].existence, 1);
  for (int k = 0; k < 9; ++k) {
    ASSERT_EQ(step(false), 1u) << k;
    EXPECT_FALSE(list.objects[0].is_measured);
  }
  EXPECT_NEAR(list.objects[0].existence, 0.505, 1e-12);
  EXPECT_NEAR(list.objects[0].age_s, 16 * kStep, 1e-9);
  EXPECT_EQ(step(false), 0u);
  // A dropped object is forgotten and confirmed anew.
  EXPECT_EQ(step(true), 0u);
  EXPECT_EQ(step(true), 0u);
  EXPECT_EQ(step(true), 1u);
  EXPECT_NE(list.objects[0].id, id);
}

TEST(TrackingModel, ACarFromBehindIsShortInItsPointsAndCompleteInItsBox) {
  TrackingModel model;
  ObjectList list;
  const std::vector<TruthObject> objects{car(1, {15, 0, 0.75}, 0)};
  for (int k = 0; k < 5; ++k) model.step(cloud_of(objects, k * kStep), {k * kStep, objects}, list);
  ASSERT_EQ(list.objects.size(), 1u);
  const TrackedObject& o = list.objects[0];
  EXPECT_LT(o.measured_size_m.x(), 0.8);
  EXPECT_NEAR(o.measured_size_m.y(), 1.8, 0.1);
  EXPECT_NEAR(o.box.size_m.x(), 4.6, 0.3);
  EXPECT_GT(o.size_sigma_m.x(), 0.2);
  EXPECT_LT((o.box.centre_m - objects[0].box.centre_m).head<2>().norm(), 0.25);
}

// Each reference point with a car that passes on the left, from ahead to behind.
class PassingCar : public testing::TestWithParam<ReferencePoint> {};

TEST_P(PassingCar, IsFollowedWithItsVelocity) {
  TrackingOptions options;
  options.track.reference = GetParam();
  TrackingModel model(options);
  ObjectList list;
  double worst = 0, speed_error = 0;
  for (int k = 0; k < 60; ++k) {
    const double t = k * kStep;
    const std::vector<TruthObject> objects{car(1, {30 - 10 * t, 6, 0.75}, M_PI)};
    model.step(cloud_of(objects, t), {t, objects}, list);
    if (k < 10) continue;
    ASSERT_EQ(list.objects.size(), 1u);
    const TrackedObject& o = list.objects[0];
    worst = std::max(worst, (o.box.centre_m - objects[0].box.centre_m).head<2>().norm());
    speed_error = std::max(speed_error, (o.velocity_m_s - Vec3(-10, 0, 0)).norm());
    EXPECT_NEAR(wrapped(o.box.yaw_rad - M_PI), 0, 0.05);
    EXPECT_GT(o.position_sigma_m.x(), 0);
  }
  // The mean of the points moves along the car while it passes, so the track follows more slowly.
  const bool moves = GetParam() == ReferencePoint::kCentreOfGravity;
  EXPECT_LT(worst, moves ? 0.9 : 0.35);
  EXPECT_LT(speed_error, moves ? 4 : 2.5);
}

INSTANTIATE_TEST_SUITE_P(References, PassingCar,
                         testing::Values(ReferencePoint::kCentreOfGravity,
                                         ReferencePoint::kGeometricCentre,
                                         ReferencePoint::kCorner));

TEST(TrackingModel, HeadingsOfTheTruthGiveThePublishedExtents) {
  TrackingOptions options;
  options.heading = HeadingSource::kTruth;
  options.track.completion.enabled = false;
  options.track.least_size_m = {0.8, 0.5, 2.0};
  TrackingModel model(options);
  ObjectList list;
  const std::vector<TruthObject> objects{car(1, {15, 0, 0.75}, 0)};
  for (int k = 0; k < 5; ++k) model.step(cloud_of(objects, k * kStep), {k * kStep, objects}, list);
  EXPECT_DOUBLE_EQ(list.objects[0].box.size_m.x(), 0.8) << "the published lower bounds";
  EXPECT_DOUBLE_EQ(list.objects[0].box.size_m.z(), 2.0);
  EXPECT_NEAR(list.objects[0].box.size_m.y(), 1.8, 0.1);
}

TEST(TrackingModel, ItsAnswerDoesNotDependOnTheWorldsFrame) {
  const OrientedBox frame{{800, -300, 4}, 2.1, {}};
  const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(2.1, Vec3::UnitZ())), {800, -300, 4}};
  TrackingModel model, moved_model;
  ObjectList list, moved_list;
  for (int k = 0; k < 20; ++k) {
    const double t = k * kStep;
    const std::vector<TruthObject> objects{car(1, {12, 3 + 2 * t, 0.75}, M_PI / 2)};
    MergedCloud cloud = cloud_of(objects, t);
    model.step(cloud, {t, objects}, list);
    std::vector<TruthObject> moved = objects;
    moved[0].box.centre_m = frame.from_box(objects[0].box.centre_m);
    moved[0].box.yaw_rad = wrapped(objects[0].box.yaw_rad + frame.yaw_rad);
    cloud.world_from_vehicle = pose;
    moved_model.step(cloud, {t, moved}, moved_list);
  }
  ASSERT_EQ(list.objects.size(), 1u);
  ASSERT_EQ(moved_list.objects.size(), 1u);
  const TrackedObject &a = list.objects[0], &b = moved_list.objects[0];
  // Headings are tried in steps from the world's axes, hence not to the last bit.
  EXPECT_LT((frame.from_box(a.box.centre_m) - b.box.centre_m).norm(), 0.05);
  EXPECT_LT((a.box.size_m - b.box.size_m).norm(), 0.1);
  EXPECT_EQ(a.existence, b.existence);
}

bool same(const ObjectList& a, const ObjectList& b) {
  if (a.objects.size() != b.objects.size()) return false;
  for (size_t k = 0; k < a.objects.size(); ++k) {
    const TrackedObject &p = a.objects[k], &q = b.objects[k];
    if (p.id != q.id || p.box.centre_m != q.box.centre_m || p.box.size_m != q.box.size_m ||
        p.existence != q.existence || p.velocity_m_s != q.velocity_m_s) {
      return false;
    }
  }
  return true;
}

TEST(TrackingModel, ACopyContinuesAsTheOriginalAndAResetBeginsAnew) {
  TrackingModel model;
  ObjectList list, other;
  std::vector<ObjectList> first;
  const auto run = [&](TrackingModel& m, int begin, int end, ObjectList& out,
                       std::vector<ObjectList>* all) {
    for (int k = begin; k < end; ++k) {
      const double t = k * kStep;
      const std::vector<TruthObject> objects{car(1, {20 - 5 * t, 3, 0.75}, M_PI),
                                             car(9, {10, -4, 0.75}, 0)};
      m.step(k % 5 == 4 ? test::empty_cloud(t) : cloud_of(objects, t), {t, objects}, out);
      if (all) all->push_back(out);
    }
  };
  run(model, 0, 12, list, &first);
  TrackingModel copy = model;
  run(model, 12, 24, list, nullptr);
  run(copy, 12, 24, other, nullptr);
  EXPECT_TRUE(same(list, other));
  model.reset();
  std::vector<ObjectList> again;
  run(model, 0, 12, list, &again);
  for (size_t k = 0; k < first.size(); ++k) EXPECT_TRUE(same(first[k], again[k])) << k;
}

TEST(TrackingModel, AnObjectThatTheTruthNoLongerHasCoasts) {
  TrackingModel model;
  ObjectList list;
  const std::vector<TruthObject> objects{car(1, {15, 2, 0.75}, 0)};
  for (int k = 0; k < 6; ++k) model.step(cloud_of(objects, k * kStep), {k * kStep, objects}, list);
  model.step(test::empty_cloud(6 * kStep), {6 * kStep, {}}, list);
  ASSERT_EQ(list.objects.size(), 1u);
  EXPECT_FALSE(list.objects[0].is_measured);
}

TEST(TrackingModel, RefusesTruthWithDoubleOrNoNumbers) {
  TrackingModel model;
  ObjectList list;
  EXPECT_THROW(model.step(test::empty_cloud(0), {0, {car(0, {9, 0, 0}, 0)}}, list),
               std::invalid_argument);
  EXPECT_THROW(
      model.step(test::empty_cloud(0), {0, {car(2, {9, 0, 0}, 0), car(2, {20, 0, 0}, 0)}}, list),
      std::invalid_argument);
}

TEST(OutputDelay, ShowsTheNewestListThatIsThere) {
  OutputDelay delay;
  EXPECT_EQ(delay.at(10), nullptr);
  for (int k = 0; k < 4; ++k) {
    ObjectList list;
    list.time_s = k;
    list.available_s = k + 1.5;
    delay.push(list);
  }
  EXPECT_EQ(delay.at(1.4), nullptr);
  EXPECT_EQ(delay.at(1.5)->time_s, 0);
  EXPECT_EQ(delay.at(3.9)->time_s, 2);
  EXPECT_EQ(delay.at(4.4)->time_s, 2) << "it stays until there is a newer one";
  EXPECT_EQ(delay.at(4.5)->time_s, 3);
}

}  // namespace
}  // namespace underbrush::perception
