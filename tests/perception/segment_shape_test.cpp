#include "underbrush/perception/segment_shape.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"

namespace underbrush::perception {
namespace {

double off_by_quarter(double a, double b) { return std::abs(wrapped(4 * (a - b))) / 4; }

TEST(ShapeFitter, FindsTheHeadingOfBoxesFromAllSides) {
  ShapeFitter fitter;
  Stream random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const double yaw = random.uniform(-M_PI, M_PI), bearing = random.uniform(-M_PI, M_PI);
    const OrientedBox box{
        {20 * std::cos(bearing), 20 * std::sin(bearing), 0.8}, yaw, {4.5, 1.8, 1.5}};
    const Vec3 viewpoint(0, 0, 1);
    auto points = test::seen_sides(box, viewpoint);
    for (Vec3& p : points) {
      const double x = random.normal(), y = random.normal();
      p += 0.02 * Vec3(x, y, 0);
    }
    const auto heading = fitter.heading(points, viewpoint);
    ASSERT_TRUE(heading);
    EXPECT_LT(off_by_quarter(*heading, yaw), 1.5 * kDegree) << "yaw " << yaw << " at " << bearing;
    const SegmentShape shape =
        ShapeFitter::measure(points, nearest_quarter(*heading, yaw), viewpoint);
    const Vec3 seen = box.to_box(viewpoint);
    if (std::abs(seen.y()) > 1) {
      EXPECT_NEAR(shape.box.size_m.x(), 4.5, 0.25);
    }
    if (std::abs(seen.x()) > 2.5) {
      EXPECT_NEAR(shape.box.size_m.y(), 1.8, 0.25);
    }
  }
}

TEST(ShapeFitter, MovingAndTurningTheSceneMovesAndTurnsTheAnswer) {
  ShapeFitter fitter;
  const OrientedBox box{{12, 7, 0.8}, 0.3, {4.5, 1.8, 1.5}};
  const auto points = test::seen_sides(box, Vec3::Zero());
  const double before = *fitter.heading(points, Vec3::Zero());
  const double turn = 20 * kDegree;
  const OrientedBox frame{{1000, -500, 3}, turn, {}};
  std::vector<Vec3> moved;
  moved.reserve(points.size());
  for (const Vec3& p : points) moved.push_back(frame.from_box(p));
  const double after = *fitter.heading(moved, frame.from_box(Vec3::Zero()));
  EXPECT_LT(off_by_quarter(after, before + turn), 1.0 * kDegree);
}

TEST(ShapeFitter, MeasureIsTheBoxAroundThePoints) {
  const OrientedBox box{{10, 5, 1}, 0.7, {4, 2, 1.5}};
  std::vector<Vec3> corners;
  corners.reserve(8);
  for (int k = 0; k < 8; ++k) {
    corners.push_back(box.from_box({k & 1 ? 2.0 : -2.0, k & 2 ? 1.0 : -1.0, k & 4 ? 0.75 : -0.75}));
  }
  const SegmentShape shape = ShapeFitter::measure(corners, 0.7, Vec3::Zero());
  EXPECT_LT((shape.box.centre_m - box.centre_m).norm(), 1e-12);
  EXPECT_LT((shape.box.size_m - box.size_m).norm(), 1e-12);
  EXPECT_LT((shape.centre_of_gravity_m - box.centre_m).norm(), 1e-12);
  EXPECT_LT((shape.viewpoint_m - box.to_box(Vec3::Zero())).norm(), 1e-12);
}

TEST(ShapeFitter, SmallSegmentsHaveNoHeading) {
  ShapeFitter fitter;
  const std::vector<Vec3> few{{10, 0, 1}, {10, 2, 1}};
  EXPECT_FALSE(fitter.heading(few, Vec3::Zero()));
  const OrientedBox person{{10, 0, 1}, 0, {0.4, 0.5, 1.7}};
  EXPECT_FALSE(fitter.heading(test::seen_sides(person, Vec3::Zero()), Vec3::Zero()));
}

TEST(NearestQuarter, TakesTheNearestOfFour) {
  EXPECT_NEAR(nearest_quarter(0.1, 3.0), wrapped(0.1 + M_PI), 1e-12);
  EXPECT_NEAR(nearest_quarter(1.5, 0), 1.5 - M_PI / 2, 1e-12);
  EXPECT_NEAR(nearest_quarter(0.2, -1.4), 0.2 - M_PI / 2, 1e-12);
}

}  // namespace
}  // namespace underbrush::perception
