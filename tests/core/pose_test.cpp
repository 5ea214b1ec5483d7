#include "underbrush/core/pose.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"
#include "underbrush/core/within.hpp"

namespace underbrush {
namespace {

Pose random_pose(Stream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal(), w = random.normal();
  const double a = random.uniform(-9, 9), b = random.uniform(-9, 9), c = random.uniform(-9, 9);
  return {Eigen::Quaterniond(w, x, y, z).normalized(), Vec3(a, b, c)};
}

TEST(Within, NumbersThatAreNoneAreNotWithin) {
  EXPECT_TRUE(is_within(Vec3(1, -2, 0), 2.5));
  for (const double odd : {double(NAN), double(INFINITY), -double(INFINITY), 2.5, -3.0}) {
    for (int c = 0; c < 3; ++c) {
      Vec3 v(1, -2, 0);
      v[c] = odd;
      EXPECT_FALSE(is_within(v, 2.5)) << odd << " at " << c;
      EXPECT_FALSE(is_within(Vec3f(v.cast<float>()), 2.5f)) << odd << " at " << c;
    }
  }
}

TEST(Pose, ActsAsAGroup) {
  Stream random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random), b = random_pose(random);
    const Vec3 p(1, 2, 3);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-12);
  }
}

TEST(Pose, InterpolationHitsBothEndsAndTurnsAtConstantRate) {
  Stream random(2);
  for (int i = 0; i < 200; ++i) {
    const Pose a = random_pose(random), b = random_pose(random);
    EXPECT_LT((interpolate(a, b, 0) * Vec3(1, 2, 3) - a * Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((interpolate(a, b, 1) * Vec3(1, 2, 3) - b * Vec3(1, 2, 3)).norm(), 1e-12);
    const Pose half = interpolate(a, b, 0.5);
    EXPECT_NEAR(a.rotation.angularDistance(half.rotation),
                half.rotation.angularDistance(b.rotation), 1e-7);
  }
}

TEST(Trajectory, InterpolatesExtrapolatesOneIntervalAndNoFurther) {
  Pose start, end;
  end.translation = Vec3(2, 0, 0);
  const Trajectory path({{1.0, end}, {0.0, start}});  // unsorted on purpose
  EXPECT_NEAR(path.at(0.25)->translation.x(), 0.5, 1e-12);
  EXPECT_NEAR(path.at(1.5)->translation.x(), 3.0, 1e-12);
  EXPECT_NEAR(path.at(-0.5)->translation.x(), -1.0, 1e-12);
  EXPECT_FALSE(path.at(2.5).has_value());
  EXPECT_FALSE(path.at(std::nan("")).has_value());
}

TEST(Trajectory, RefusesTwoPosesAtOneTime) {
  EXPECT_THROW(Trajectory({{1.0, {}}, {1.0, {}}}), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush
