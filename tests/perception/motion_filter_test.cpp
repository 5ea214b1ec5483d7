#include "underbrush/perception/motion_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {
namespace {

constexpr double kStep = 0.08;

// A point on a circle that is driven at a constant speed.
struct Circle {
  double radius = 12, speed = 6, start = 0.3;
  double rate() const { return speed / radius; }
  double yaw(double t) const { return start + rate() * t; }
  Vec3 at(double t) const { return {radius * std::sin(yaw(t)), -radius * std::cos(yaw(t)), 0.5}; }
};

MotionFilter follow(const Circle& circle, const MotionOptions& options, int cycles, double sigma_m,
                    bool with_yaw, uint64_t seed) {
  MotionFilter filter;
  Stream random(seed);
  Vec3 last = Vec3::Zero();
  for (int k = 0; k < cycles; ++k) {
    const double t = k * kStep;
    const double x = random.normal(), y = random.normal();
    const Vec3 seen = circle.at(t) + sigma_m * Vec3(x, y, 0);
    std::optional<double> yaw;
    if (with_yaw) yaw = circle.yaw(t);
    if (k == 0) {
      filter.start(options, seen, yaw, 0);
    } else {
      filter.predict(options, kStep);
      if (k == 1) filter.set_velocity(options, seen - last, kStep, with_yaw);
      filter.update(options, seen, yaw, k == 1 ? 0 : kStep);
    }
    last = seen;
  }
  return filter;
}

TEST(MotionFilter, PredictionFollowsACircleExactly) {
  const Circle circle;
  const MotionOptions options;
  MotionFilter filter = follow(circle, options, 200, 0, true, 1);
  const double t = 199 * kStep;
  EXPECT_NEAR(filter.speed_m_s(), 6, 1e-3);
  EXPECT_NEAR(filter.yaw_rate_rad_s(), 0.5, 1e-3);
  filter.predict(options, 2);
  EXPECT_LT((filter.position_m() - circle.at(t + 2)).norm(), 0.01);
  EXPECT_NEAR(wrapped(filter.yaw_rad() - circle.yaw(t + 2)), 0, 1e-3);
  EXPECT_NEAR(filter.acceleration_m_s2().norm(), 6 * 0.5, 0.02) << "centripetal";
}

TEST(MotionFilter, ConvergesWithoutMeasuredHeadings) {
  const Circle circle;
  const MotionFilter filter = follow(circle, {}, 60, 0.03, false, 2);
  EXPECT_NEAR(filter.speed_m_s(), 6, 0.4);
  EXPECT_NEAR(wrapped(filter.yaw_rad() - circle.yaw(59 * kStep)), 0, 0.1);
}

TEST(MotionFilter, PredictionIsTheSumOfItsSteps) {
  const MotionFilter start = follow({}, {}, 50, 0, true, 1);
  MotionFilter once = start, often = start;
  once.predict({}, 1);
  for (int k = 0; k < 100; ++k) often.predict({}, 0.01);
  EXPECT_LT((once.state() - often.state()).norm(), 1e-9);
}

// The Jacobian of the prediction, against differences.
TEST(MotionFilter, CovarianceFollowsTheMotionOfASample) {
  MotionOptions options;
  options.acceleration_m_s2 = options.yaw_acceleration_rad_s2 = 1e-9;
  const MotionFilter start = follow({}, MotionOptions{}, 30, 0.05, true, 4);
  MotionFilter predicted = start;
  predicted.predict(options, 0.5);
  const auto move = [](const MotionFilter::State& x, double t) {
    MotionFilter::State y = x;
    y[0] += x[3] / x[4] * (std::sin(x[2] + x[4] * t) - std::sin(x[2]));
    y[1] += x[3] / x[4] * (std::cos(x[2]) - std::cos(x[2] + x[4] * t));
    y[2] += x[4] * t;
    return y;
  };
  MotionFilter::Covariance f;
  for (int k = 0; k < 5; ++k) {
    MotionFilter::State high = start.state(), low = start.state();
    high[k] += 1e-5;
    low[k] -= 1e-5;
    f.col(k) = (move(high, 0.5) - move(low, 0.5)) / 2e-5;
  }
  const MotionFilter::Covariance expected = f * start.covariance() * f.transpose();
  EXPECT_LT((predicted.covariance() - expected).norm(), 1e-6 * expected.norm());
}

// The normalised squared error of a consistent filter has the mean 5, the number of its states.
TEST(MotionFilter, ItsCovarianceIsThatOfItsErrors) {
  MotionOptions options;
  options.acceleration_m_s2 = 1;
  options.yaw_acceleration_rad_s2 = 0.3;
  double sum = 0;
  constexpr int kRuns = 300;
  for (uint64_t run = 0; run < kRuns; ++run) {
    Stream random(100 + run);
    double x = 0, y = 0, yaw = random.uniform(-3, 3), v = random.uniform(4, 10);
    double rate = random.uniform(-0.3, 0.3);
    MotionFilter filter;
    Vec3 last = Vec3::Zero();
    for (int k = 0; k < 40; ++k) {
      if (k) {
        const double a = options.acceleration_m_s2 * random.normal();
        const double b = options.yaw_acceleration_rad_s2 * random.normal();
        const double chord = v * kStep, direction = yaw + rate * kStep / 2;
        x += chord * std::cos(direction) + a * kStep * kStep / 2 * std::cos(yaw);
        y += chord * std::sin(direction) + a * kStep * kStep / 2 * std::sin(yaw);
        yaw += rate * kStep + b * kStep * kStep / 2;
        v += a * kStep;
        rate += b * kStep;
      }
      const double ex = random.normal(), ey = random.normal(), eyaw = random.normal();
      const Vec3 seen(x + options.position_m * ex, y + options.position_m * ey, 0);
      const double heading = wrapped(yaw + options.yaw_rad * eyaw);
      if (k == 0) {
        filter.start(options, seen, heading, 0);
      } else {
        filter.predict(options, kStep);
        if (k == 1) filter.set_velocity(options, seen - last, kStep, true);
        filter.update(options, seen, heading, k == 1 ? 0 : kStep);
      }
      last = seen;
    }
    MotionFilter::State e;
    e << x, y, yaw, v, rate;
    e -= filter.state();
    e[2] = wrapped(e[2]);
    sum += e.dot(inverse(filter.covariance()) * e);
  }
  // Three standard deviations of the mean are 3 sqrt(10 / 300) = 0.55.
  EXPECT_NEAR(sum / kRuns, 5, 0.8);
}

TEST(MotionFilter, CovarianceStaysPositive) {
  MotionFilter filter = follow({}, {}, 500, 0.1, true, 9);
  EXPECT_EQ(filter.covariance().llt().info(), Eigen::Success);
  for (int k = 0; k < 100; ++k) filter.predict({}, 0.1);
  EXPECT_EQ(filter.covariance().llt().info(), Eigen::Success);
}

TEST(MotionFilter, AHalfTurnKeepsTheVelocity) {
  MotionFilter filter = follow({}, {}, 100, 0, true, 1);
  const Vec3 before = filter.velocity_m_s();
  filter.turn({}, 2);
  EXPECT_LT((filter.velocity_m_s() - before).norm(), 1e-9);
  EXPECT_LT(filter.speed_m_s(), 0);
}

}  // namespace
}  // namespace underbrush::perception
