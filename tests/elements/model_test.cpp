#include "underbrush/elements/model.hpp"

#include <gtest/gtest.h>

#include "trace/scenes.hpp"
#include "underbrush/core/linear.hpp"

namespace underbrush::elements {
namespace {

TEST(Model, NumbersGroundThenSurfaceThenEllipsoids) {
  Model m = trace::random_model(1);
  EXPECT_EQ(m.kind(0), Kind::kGround);
  EXPECT_EQ(m.kind(m.ground.size()), Kind::kSurface);
  EXPECT_EQ(m.kind(m.size() - 1), Kind::kEllipsoid);
  m.hit(m.ground.size()).hits = 42;
  EXPECT_EQ(m.surface.hit[0].hits, 42u);
  m.hit(m.size() - 1).hits = 43;
  EXPECT_EQ(m.ellipsoids.back().hit.hits, 43u);
}

TEST(Model, CheckRefusesWhatNoTracerCouldUse) {
  const Model good = trace::random_model(2);
  const auto refused = [&](auto change) {
    Model m = good;
    change(m);
    EXPECT_THROW(m.check(), std::invalid_argument);
  };
  refused([](Model& m) { m.tau = 0; });
  refused([](Model& m) { m.origin.x() = NAN; });
  refused([](Model& m) { m.ground.vertices[0].x() = INFINITY; });
  refused([](Model& m) { m.ground.triangles[0][2] = 1u << 30; });
  refused([](Model& m) { m.surface.hit.pop_back(); });
  refused([](Model& m) { m.ellipsoids[0].hit.p = 1.5f; });
  refused([](Model& m) { m.ellipsoids[0].covariance = {1, 0, 0, -1, 0, 1}; });
  refused([](Model& m) { m.ellipsoids[0].mean.z() = NAN; });
}

TEST(FlooredCovariance, RaisesOnlyTheEigenvaluesBelowTheFloor) {
  Stream random(3);
  for (int i = 0; i < 100; ++i) {
    Mat3 sigma = trace::random_covariance(random, 0.001, 1);
    const Mat3 out = floored_covariance(sigma, 0.02);
    const Vec3 before = eigenvalues(sigma);
    const Vec3 after = eigenvalues(out);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(after[k], std::max(before[k], 4e-4), 1e-9 * (1 + before[2]));
    }
  }
  EXPECT_TRUE(floored_covariance(Mat3::Zero(), 0.1).isApprox(0.01 * Mat3::Identity()));
}

// Both hold: no variance is below that of either matrix, and where one is the greater in all
// directions, it is the result.
TEST(FlooredCovariance, IsBelowNeitherMatrixInAnyDirection) {
  Stream random(5);
  for (int i = 0; i < 200; ++i) {
    const Mat3 sigma = trace::random_covariance(random, 0.001, 1);
    const Mat3 least = trace::random_covariance(random, 0.001, 1);
    const Mat3 out = floored_covariance(sigma, least);
    for (int k = 0; k < 50; ++k) {
      const Vec3 n(random.normal(), random.normal(), random.normal());
      const double variance = n.dot(out * n) * (1 + 1e-6);
      EXPECT_GE(variance, n.dot(sigma * n));
      EXPECT_GE(variance, n.dot(least * n));
    }
    EXPECT_TRUE(floored_covariance(sigma, Mat3(0.5 * sigma)).isApprox(sigma, 1e-9));
    EXPECT_TRUE(floored_covariance(Mat3(0.5 * sigma), sigma).isApprox(sigma, 1e-6));
  }
  // In the plane of two crossing discs the result is no wider than both together.
  const Mat3 flat = Vec3(1, 1, 0.01).asDiagonal(), tall = Vec3(1, 0.01, 1).asDiagonal();
  EXPECT_TRUE(floored_covariance(flat, tall).isApprox(Mat3::Identity(), 1e-9));
}

}  // namespace
}  // namespace underbrush::elements
