#include "underbrush/credit/mesh_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"

namespace underbrush::credit {
namespace {

elements::TriangleMesh floor_mesh() {
  elements::TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Adds returns of beams at all grazing angles, of which a share is anywhere.
void add_returns(MeshResiduals& residuals, size_t n, double sigma_m, double roughness_m,
                 double outliers, Stream& random) {
  const elements::TriangleMesh mesh = floor_mesh();
  for (size_t k = 0; k < n; ++k) {
    const double cosine = std::pow(10, random.uniform(-1.5, 0));
    const Vec3 down(std::sqrt(1 - cosine * cosine), 0, -cosine);
    const bool is_outlier = random.uniform() < outliers;
    const double off = std::hypot(sigma_m, roughness_m / cosine) * random.normal();
    residuals.add(mesh, 0, down, is_outlier ? random.uniform(-0.75, 0.75) : off);
  }
}

TEST(MeshNoise, IsFoundAgainBesideOutliers) {
  Stream random(7);
  const double cases[][3] = {{0.02, 0.02, 0}, {0.03, 0.005, 0.02}, {0.01, 0.05, 0.1}};
  for (const auto& [sigma_m, roughness_m, outliers] : cases) {
    MeshResiduals residuals(0.75);
    add_returns(residuals, 100000, sigma_m, roughness_m, outliers, random);
    const auto noise = residuals.noise(0.001);
    ASSERT_TRUE(noise);
    for (const double cosine : {1.0, 0.3, 0.1}) {
      EXPECT_NEAR(std::hypot(noise->range_sigma_m, noise->roughness_m / cosine) /
                      std::hypot(sigma_m, roughness_m / cosine),
                  1, 0.03);
    }
    // The noise that is a fifth of the other shows in 4 % of the variance.
    EXPECT_NEAR(noise->range_sigma_m / sigma_m, 1, 0.25);
    EXPECT_NEAR(noise->roughness_m / roughness_m, 1, 0.05);
  }
}

// Residuals that end at 0.75 m hide the tails of a noise that is as large.
TEST(MeshNoise, KnowsThatLargeResidualsDoNotCount) {
  Stream random(8);
  MeshResiduals residuals(0.75);
  add_returns(residuals, 200000, 0.5, 0.001, 0, random);
  EXPECT_NEAR(residuals.noise(0.001)->range_sigma_m, 0.5, 0.05);
}

TEST(MeshNoise, NeedsReturnsAndKeepsTheLeastNoise) {
  Stream random(9);
  MeshResiduals residuals(0.75);
  add_returns(residuals, 199, 0.02, 0.02, 0, random);
  EXPECT_FALSE(residuals.noise(0.001));
  elements::TriangleMesh mesh = floor_mesh();
  mesh.roughness_m = 0.3;
  set_noise(mesh, residuals, 0.001);
  EXPECT_EQ(mesh.roughness_m, 0.3);
  add_returns(residuals, 1000, 0.02, 0.02, 0, random);
  EXPECT_GE(residuals.noise(0.1)->range_sigma_m, 0.0999);
}

}  // namespace
}  // namespace underbrush::credit
