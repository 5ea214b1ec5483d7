#include "underbrush/perception/object_pipeline.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::perception {
namespace {

constexpr double kCycle = 0.08;

TEST(Clusters, SeparateBoxesFromTheGroundAndFromEachOther) {
  MergedCloud cloud = test::empty_cloud(0);
  test::add_ground(cloud);
  const size_t ground = cloud.size();
  test::add_box(cloud, {{12, 3, 0.75}, 0.2, {4.5, 1.8, 1.5}});
  const size_t first = cloud.size();
  test::add_box(cloud, {{12, -3, 0.75}, 0, {4.5, 1.8, 1.5}});
  std::vector<Vec3> world;
  to_world(cloud, world);
  for (const char* method : {"cone", "lower_envelope"}) {
    ClusterOptions options;
    options.ground = method;
    Clusters clusters(options);
    Segments segments;
    clusters.find(cloud, world, segments);
    EXPECT_EQ(segments.size(), 2u) << method;
    size_t wrong = 0;
    for (size_t i = 0; i < cloud.size(); ++i) {
      const bool is_low = cloud.point_m[i].z() < 0.45f;
      if (i < ground) wrong += segments.of_point[i] != kNoSegment;
      if (i >= ground && !is_low) wrong += segments.of_point[i] != (i < first ? 0u : 1u);
    }
    EXPECT_EQ(wrong, 0u) << method;
  }
}

TEST(Clusters, TheGroundMayRise) {
  MergedCloud cloud = test::empty_cloud(0);
  for (double x = -30; x <= 30; x += 0.4) {
    for (double y = -30; y <= 30; y += 0.4) test::add_point(cloud, {x, y, 0.1 * x});
  }
  std::vector<Vec3> world;
  to_world(cloud, world);
  Clusters clusters;
  Segments segments;
  clusters.find(cloud, world, segments);
  EXPECT_EQ(segments.size(), 0u);
}

TEST(Clusters, ReflectionsBelowTheGroundDoNoHarm) {
  MergedCloud cloud = test::empty_cloud(0);
  test::add_ground(cloud);
  test::add_box(cloud, {{12, 3, 0.75}, 0.2, {4.5, 1.8, 1.5}});
  for (double x = 11; x < 14; x += 0.1) {
    for (double z = -5; z < -3; z += 0.1) test::add_point(cloud, {x, 4, z});
  }
  const size_t all = test::seen_sides({{12, 3, 0.75}, 0.2, {4.5, 1.8, 1.5}}, {0, 0, 1}).size();
  std::vector<Vec3> world;
  to_world(cloud, world);
  Clusters clusters;
  Segments segments;
  clusters.find(cloud, world, segments);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_GT(double(segments.points(0).size()), 0.8 * double(all));
}

TEST(Clusters, TheOrderOfThePointsMeansNothingToTheClusters) {
  MergedCloud cloud = test::empty_cloud(0), turned = test::empty_cloud(0);
  test::add_ground(cloud, 20);
  for (int k = 0; k < 8; ++k) {
    test::add_box(cloud, {{6.0 + 3 * k, 4.0 * (k % 3) - 4, 0.8}, 0.3 * k, {2.5, 1.2, 1.6}});
  }
  for (size_t i = cloud.size(); i-- > 0;) test::add_point(turned, cloud.point_m[i].cast<double>());
  std::vector<Vec3> world, back;
  to_world(cloud, world);
  to_world(turned, back);
  Clusters clusters;
  Segments a, b;
  clusters.find(cloud, world, a);
  clusters.find(turned, back, b);
  ASSERT_EQ(a.size(), b.size());
  const size_t n = cloud.size();
  for (size_t i = 0; i + 1 < n; ++i) {
    const bool together = a.of_point[i] == a.of_point[i + 1];
    EXPECT_EQ(together, b.of_point[n - 1 - i] == b.of_point[n - 2 - i]);
  }
}

// A van with a thing on its roof that is seen apart from its sides, and a pedestrian beside it.
TEST(ObjectPipeline, PartsInTheFootprintOfASegmentBelongToIt) {
  MergedCloud cloud = test::empty_cloud(0);
  test::add_ground(cloud, 40);
  test::add_box(cloud, {{8, 3, 1}, 0, {5, 2.4, 2}});
  test::add_box(cloud, {{8, 3, 1.8}, 0, {0.5, 0.2, 0.8}});
  test::add_box(cloud, {{8, -0.2, 0.9}, 0, {0.5, 0.5, 1.8}});
  std::vector<Vec3> world;
  to_world(cloud, world);
  Clusters clusters;
  Segments apart;
  clusters.find(cloud, world, apart);
  ASSERT_EQ(apart.size(), 3u);
  ObjectPipeline pipeline;
  ObjectList list;
  pipeline.step(cloud, list);
  const Segments& joined = pipeline.segments();
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_EQ(joined.points(0).size(), apart.points(0).size() + apart.points(1).size());
  EXPECT_EQ(joined.points(1).size(), apart.points(2).size());
}

// A car that drives ahead, and one that stands.
void scene(int cycle, MergedCloud& cloud) {
  const double t = kCycle * cycle;
  cloud = test::empty_cloud(t);
  test::add_ground(cloud, 40);
  test::add_box(cloud, {{10 + 8 * t, -2, 0.75}, 0, {4.5, 1.8, 1.5}}, 0.1, 0.02,
                40 + uint64_t(cycle));
  test::add_box(cloud, {{18, 6, 0.75}, 0.1, {4.5, 1.8, 1.5}}, 0.1, 0.02, 90 + uint64_t(cycle));
}

TEST(ObjectPipeline, FindsFollowsAndNamesCars) {
  ObjectPipeline pipeline;
  ObjectList list;
  MergedCloud cloud;
  for (int k = 0; k < 30; ++k) {
    scene(k, cloud);
    pipeline.step(cloud, list);
    EXPECT_EQ(list.objects.size(), k < 2 ? 0u : 2u) << k;
  }
  ASSERT_EQ(list.objects.size(), 2u);
  const bool moves_first =
      list.objects[0].velocity_m_s.norm() > list.objects[1].velocity_m_s.norm();
  const TrackedObject& moving = list.objects[moves_first ? 0 : 1];
  const TrackedObject& standing = list.objects[moves_first ? 1 : 0];
  EXPECT_LT((moving.velocity_m_s - Vec3(8, 0, 0)).norm(), 0.6);
  EXPECT_LT((moving.box.centre_m - Vec3(10 + 8 * 29 * kCycle, -2, 0.75)).head<2>().norm(), 0.5);
  EXPECT_NEAR(wrapped(moving.box.yaw_rad), 0, 0.06);
  EXPECT_EQ(moving.label, ObjectClass::kCar);
  EXPECT_LT(standing.velocity_m_s.norm(), 0.5);
  EXPECT_LT((standing.box.centre_m - Vec3(18, 6, 0.75)).head<2>().norm(), 0.4);
  EXPECT_EQ(standing.label, ObjectClass::kCar);
  EXPECT_LE(std::max(moving.id, standing.id), 2u) << "no track was begun twice";
}

TEST(ObjectPipeline, HasTheTrackManagementOfTheModel) {
  ObjectPipeline pipeline;
  ObjectList list;
  MergedCloud cloud;
  for (int k = 0; k < 10; ++k) {
    scene(k, cloud);
    pipeline.step(cloud, list);
  }
  for (int k = 10; k < 19; ++k) {
    cloud = test::empty_cloud(k * kCycle);
    test::add_ground(cloud, 40);
    pipeline.step(cloud, list);
    ASSERT_EQ(list.objects.size(), 2u) << k;
  }
  EXPECT_NEAR(list.objects[0].existence, 0.505, 1e-12);
  cloud.time_s = 19 * kCycle;
  pipeline.step(cloud, list);
  EXPECT_TRUE(list.objects.empty());
}

TEST(ObjectPipeline, ACopyContinuesAsTheOriginal) {
  ObjectPipeline pipeline;
  ObjectList list, other;
  MergedCloud cloud;
  for (int k = 0; k < 8; ++k) {
    scene(k, cloud);
    pipeline.step(cloud, list);
  }
  ObjectPipeline copy = pipeline;
  for (int k = 8; k < 16; ++k) {
    scene(k, cloud);
    pipeline.step(cloud, list);
    copy.step(cloud, other);
  }
  ASSERT_EQ(list.objects.size(), other.objects.size());
  for (size_t k = 0; k < list.objects.size(); ++k) {
    EXPECT_EQ(list.objects[k].box.centre_m, other.objects[k].box.centre_m);
    EXPECT_EQ(list.objects[k].probability, other.objects[k].probability);
  }
}

// A standing car across the road shows only its rear at first, and then its side.
TEST(ObjectPipeline, AnExtentThatNoWidthHasBecomesTheLength) {
  ObjectPipeline pipeline;
  ObjectList list;
  const OrientedBox car{{14, 0, 0.75}, M_PI / 2, {4.5, 1.8, 1.5}};
  for (int k = 0; k < 12; ++k) {
    MergedCloud cloud = test::empty_cloud(kCycle * k);
    test::add_ground(cloud, 40);
    for (const Vec3& p : test::seen_sides(car, {0, 0, 1})) {
      if (k > 5 || p.y() < -0.5) test::add_point(cloud, p);
    }
    pipeline.step(cloud, list);
  }
  ASSERT_EQ(list.objects.size(), 1u);
  EXPECT_NEAR(std::abs(wrapped(list.objects[0].box.yaw_rad)), M_PI / 2, 0.1);
  EXPECT_NEAR(list.objects[0].box.size_m.x(), 4.5, 0.3);
}

// The corner that is nearest to the vehicle changes as the car passes, which is no motion.
TEST(ObjectPipeline, AChangeOfTheCornerDoesNotTurnTheBox) {
  ObjectPipeline pipeline;
  ObjectList list;
  for (int k = 0; k < 50; ++k) {
    const double t = kCycle * k;
    MergedCloud cloud = test::empty_cloud(t);
    test::add_ground(cloud, 40);
    test::add_box(cloud, {{-12 + 7 * t, 5, 0.75}, 0, {4.5, 1.8, 1.5}}, 0.1, 0.02, 7 + uint64_t(k));
    pipeline.step(cloud, list);
    if (k < 8) continue;
    ASSERT_EQ(list.objects.size(), 1u) << k;
    EXPECT_NEAR(wrapped(list.objects[0].box.yaw_rad), 0, 0.15) << k;
    EXPECT_NEAR(list.objects[0].velocity_m_s.x(), 7, 1.5) << k;
  }
}

// A car that comes from the side begins with a wrong heading, because only its front shows.
TEST(ObjectPipeline, TheDirectionOfMotionCorrectsTheHeading) {
  ObjectPipeline pipeline;
  ObjectList list;
  for (int k = 0; k < 40; ++k) {
    const double t = kCycle * k;
    MergedCloud cloud = test::empty_cloud(t);
    test::add_ground(cloud, 40);
    test::add_box(cloud, {{12, -14 + 7 * t, 0.75}, M_PI / 2, {4.5, 1.8, 1.5}}, 0.1, 0.02,
                  7 + uint64_t(k));
    pipeline.step(cloud, list);
  }
  ASSERT_EQ(list.objects.size(), 1u);
  EXPECT_NEAR(wrapped(list.objects[0].box.yaw_rad - M_PI / 2), 0, 0.1);
  EXPECT_NEAR(list.objects[0].velocity_m_s.y(), 7, 0.7);
}

}  // namespace
}  // namespace underbrush::perception
