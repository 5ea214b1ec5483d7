#include "underbrush/perception/segments.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush::perception {
namespace {

TruthObject object(uint64_t id, const Vec3& centre, double yaw, const Vec3& size) {
  return {id, ObjectClass::kCar, {centre, yaw, size}};
}

// The rule without the grid of cells.
uint32_t slow(const Vec3& p, const std::vector<TruthObject>& objects,
              const BoxAssignmentOptions& o) {
  uint32_t best = kNoSegment;
  double deepest = 1;
  for (uint32_t k = 0; k < objects.size(); ++k) {
    const Vec3 q = objects[k].box.to_box(p), half = objects[k].box.size_m / 2;
    if (q.z() < -half.z() + o.above_bottom_m || q.z() > half.z() + o.margin_m) continue;
    const double depth = std::max(std::abs(q.x()) / (half.x() + o.margin_m),
                                  std::abs(q.y()) / (half.y() + o.margin_m));
    if (depth < deepest) {
      deepest = depth;
      best = k;
    }
  }
  return best;
}

TEST(BoxAssignment, AgreesWithTheTestOfEveryBox) {
  Stream random(7);
  std::vector<TruthObject> objects;
  std::vector<Vec3> points;
  for (uint64_t k = 0; k < 60; ++k) {
    const double x = random.uniform(-30, 30), y = random.uniform(-30, 30);
    const double yaw = random.uniform(-4, 4), length = random.uniform(0.5, 9);
    objects.push_back(object(k + 1, {x, y, 1}, yaw, {length, 2, 2}));
  }
  for (int k = 0; k < 20000; ++k) {
    const double x = random.uniform(-40, 40), y = random.uniform(-40, 40);
    const double z = random.uniform(-0.5, 3);
    points.emplace_back(x, y, z);
  }
  BoxAssignmentOptions options;
  BoxAssignment assignment(options);
  Segments segments;
  assignment.assign(points, objects, segments);
  size_t inside = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(segments.of_point[i], slow(points[i], objects, options)) << i;
    inside += segments.of_point[i] != kNoSegment;
  }
  EXPECT_GT(inside, 1000u);
}

TEST(BoxAssignment, AssignsNothingWithoutBoxesAndNothingToPointsThatAreNotFinite) {
  Segments segments;
  BoxAssignment assignment;
  assignment.assign(std::vector<Vec3>{{0, 0, 0}}, {}, segments);
  EXPECT_EQ(segments.of_point, std::vector<uint32_t>{kNoSegment});
  const std::vector<TruthObject> box{object(1, {0, 0, 0}, 0, {2, 2, 2})};
  assignment.assign(std::vector<Vec3>{{NAN, 0, 0}, {INFINITY, 0, 0}, {0, 0, 0}}, box, segments);
  EXPECT_EQ(segments.of_point, (std::vector<uint32_t>{kNoSegment, kNoSegment, 0}));
}

TEST(Segments, GatherKeepsOrderAndEmptySegments) {
  Segments s;
  s.of_point = {2, kNoSegment, 0, 2, 0};
  std::vector<Vec3> points;
  points.reserve(5);
  for (int k = 0; k < 5; ++k) points.emplace_back(k, 0, 0);
  s.gather(points, 3);
  ASSERT_EQ(s.size(), 3u);
  EXPECT_EQ(s.points(0).size(), 2u);
  EXPECT_EQ(s.points(0)[1].x(), 4);
  EXPECT_TRUE(s.points(1).empty());
  EXPECT_EQ(s.points(2)[0].x(), 0);
  EXPECT_EQ(s.points(2)[1].x(), 3);
}

}  // namespace
}  // namespace underbrush::perception
