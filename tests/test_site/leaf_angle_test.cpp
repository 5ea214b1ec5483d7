#include "underbrush/test_site/leaf_angle.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::test_site {
namespace {

class LeafAngles : public testing::TestWithParam<LeafAngle> {};

TEST_P(LeafAngles, DensityIsTheDerivativeOfTheDistribution) {
  constexpr double kStep = 1e-5;
  for (double t = 0.05; t < M_PI_2 - 0.05; t += 0.05) {
    const double slope =
        (leaf_angle_cdf(GetParam(), t + kStep) - leaf_angle_cdf(GetParam(), t - kStep)) /
        (2 * kStep);
    EXPECT_NEAR(leaf_angle_density(GetParam(), t), slope, 1e-8) << t;
  }
  EXPECT_NEAR(leaf_angle_cdf(GetParam(), 0), 0, 1e-15);
  EXPECT_NEAR(leaf_angle_cdf(GetParam(), M_PI_2), 1, 1e-15);
}

TEST_P(LeafAngles, QuantileInvertsTheDistribution) {
  for (double u = 0.01; u < 1; u += 0.01) {
    EXPECT_NEAR(leaf_angle_cdf(GetParam(), leaf_angle_quantile(GetParam(), u)), u, 1e-8);
  }
}

// Whatever the leaf angles, the projected area averaged over all directions is half of the leaf
// area (Cauchy).
TEST_P(LeafAngles, ProjectionAveragesToOneHalfOverTheSphere) {
  double mean = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i) {
    const double b = (i + 0.5) * M_PI_2 / n;
    mean += leaf_projection(GetParam(), b) * std::sin(b) * M_PI_2 / n;
  }
  EXPECT_NEAR(mean, 0.5, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(All, LeafAngles,
                         testing::Values(LeafAngle::kSpherical, LeafAngle::kUniform,
                                         LeafAngle::kPlanophile, LeafAngle::kErectophile,
                                         LeafAngle::kPlagiophile, LeafAngle::kExtremophile));

TEST(LeafProjection, OfSphericalLeavesIsOneHalfInEveryDirection) {
  for (double b = 0; b < M_PI_2; b += 0.1) {
    EXPECT_NEAR(leaf_projection(LeafAngle::kSpherical, b), 0.5, 1e-6) << b;
  }
}

TEST(LeafProjection, SeenFromAboveIsTheMeanCosine) {
  EXPECT_NEAR(leaf_projection(LeafAngle::kUniform, 0), M_2_PI, 1e-6);
  EXPECT_NEAR(leaf_projection(LeafAngle::kPlanophile, 0), M_2_PI * 4 / 3, 1e-6);
  EXPECT_NEAR(leaf_projection(LeafAngle::kErectophile, 0), M_2_PI * 2 / 3, 1e-6);
}

}  // namespace
}  // namespace underbrush::test_site
