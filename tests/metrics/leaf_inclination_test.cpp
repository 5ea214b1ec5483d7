#include "underbrush/metrics/leaf_inclination.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "underbrush/core/rng.hpp"

namespace underbrush::metrics {
namespace {

TEST(LeafInclination, OfPlanesIsThatOfThePlane) {
  Stream random(1);
  for (const double tilt : {0.0, 0.4, 1.2}) {
    const Mat3 turn = Eigen::AngleAxisd(tilt, Vec3::UnitX()).toRotationMatrix();
    std::vector<Vec3f> cloud;
    cloud.reserve(500);
    for (int i = 0; i < 500; ++i) {
      cloud.push_back((turn * Vec3(random.uniform(), random.uniform(), 0)).cast<float>());
    }
    const LeafInclination leaves = leaf_inclination(cloud);
    // Both signs occur, so every angle is the tilt or its supplement.
    const double width = M_PI / double(LeafInclination::kBins);
    for (size_t k = 0; k < LeafInclination::kBins; ++k) {
      const double angle = (double(k) + 0.5) * width;
      if (leaves.count[k] == 0) continue;
      EXPECT_LE(std::min(std::abs(angle - tilt), std::abs(M_PI - angle - tilt)), width) << tilt;
    }
  }
}

// Normals that are uniform over the sphere have σ = √(π²/4 − 2) = 0.684 about π/2. Points without
// order thus come near to what is measured on leaves.
TEST(LeafInclination, OfPointsWithoutOrderIsSpherical) {
  Stream random(2);
  std::vector<Vec3f> cloud;
  cloud.reserve(20000);
  for (int i = 0; i < 20000; ++i) {
    cloud.emplace_back(float(random.uniform()), float(random.uniform()), float(random.uniform()));
  }
  const LeafInclination leaves = leaf_inclination(cloud);
  double folded = 0;  // without regard to the sign
  for (size_t k = 0; k < LeafInclination::kBins; ++k) {
    const double angle = (double(k) + 0.5) * M_PI / double(LeafInclination::kBins);
    folded += std::abs(std::cos(angle)) * double(leaves.count[k]) / 20000;
  }
  EXPECT_NEAR(folded, 0.5, 0.02);
}

TEST(LeafInclination, TheGapIsSmallOfAGaussianAndThatOfTheStepsOtherwise) {
  LeafInclination leaves;
  leaves.points = 1000000;
  leaves.mean_rad = M_PI / 2;
  leaves.sigma_rad = 0.4;
  const auto below = [&](size_t k) {
    const double angle = double(k) * M_PI / double(LeafInclination::kBins);
    return 0.5 * std::erfc((leaves.mean_rad - angle) / (leaves.sigma_rad * std::sqrt(2.0)));
  };
  for (size_t k = 0; k < LeafInclination::kBins; ++k) {
    leaves.count[k] = uint64_t(1e6 * (below(k + 1) - below(k)));
  }
  EXPECT_LT(leaves.gaussian_gap(), 1e-3);
  // With two directions at ±σ and half of the points each, the share is ½ where the Gaussian has at
  // most Φ(−1).
  leaves.count = {};
  leaves.count[13] = leaves.count[22] = 500000;
  EXPECT_NEAR(leaves.gaussian_gap(), 0.5 - below(14), 1e-6);
  EXPECT_NEAR(leaves.gaussian_gap(), 0.31, 0.05);
}

TEST(LeafInclination, EpsilonIsTheDistanceOfThePaper) {
  LeafInclination leaves;
  leaves.mean_rad = 1.65 - 0.06;
  leaves.sigma_rad = 0.747 + 0.08;
  EXPECT_NEAR(leaves.epsilon(), 0.1, 1e-12);
  EXPECT_TRUE(leaves.is_realistic());
  leaves.mean_rad = 1.5;
  EXPECT_FALSE(leaves.is_realistic());
}

TEST(LogRegression, RecoversTheLineOfThePaper) {
  std::vector<double> count, epsilon;
  for (const double n : {1e3, 2e4, 5e5, 3e6}) {
    count.push_back(n);
    epsilon.push_back(0.269 - 0.0121 * std::log(n));
  }
  const LogRegression line = log_regression(count, epsilon);
  EXPECT_NEAR(line.a, 0.269, 1e-12);
  EXPECT_NEAR(line.b, 0.0121, 1e-12);
  EXPECT_NEAR(line.r2, 1, 1e-9);
  EXPECT_NEAR(line.count_at(0.11), 509e3, 20e3);  // printed as 491 000
  EXPECT_THROW(log_regression(std::span(count).first(2), std::span(epsilon).first(2)),
               std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::metrics
