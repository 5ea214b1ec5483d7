#include "underbrush/elements/light.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "underbrush/elements/element_light.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::elements {
namespace {

Model of_variances(const Vec3& variance, const Mat3& turn = Mat3::Identity()) {
  Model model;
  model.ellipsoids.resize(1);
  model.ellipsoids[0].set_covariance(turn * variance.asDiagonal() * turn.transpose());
  return model;
}

TEST(Light, GainsAreLinearBetweenKnotsAndConstantBeyond) {
  const Gain g{{1, 2, 4}, {10, 20, 0.5}};
  EXPECT_EQ(g(0), 10);
  EXPECT_EQ(g(1.5), 15);
  EXPECT_EQ(g(3), 10.25);
  EXPECT_EQ(g(9), 0.5);
  EXPECT_EQ(Gain{}(3), 1);
  EXPECT_THROW((Gain{{1, 1}, {1, 1}}.check()), std::invalid_argument);
  EXPECT_THROW((Gain{{1, 2}, {1, 0}}.check()), std::invalid_argument);
  EXPECT_THROW((Gain{{1, 2}, {1}}.check()), std::invalid_argument);
}

TEST(Light, ABallHasTheSameCosineFromEverywhere) {
  const Model ball = of_variances({0.3, 0.3, 0.3});
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0.6, 0, 0.8), Vec3(0.36, 0.48, 0.8)}) {
    EXPECT_NEAR(incidence_cosine(ball, 0, d), 1 / std::sqrt(3.0), 1e-6);
  }
}

TEST(Light, AFlatEllipsoidHasTheCosineOfItsPlane) {
  const Mat3 turn = (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  const Model flat = of_variances({1, 1, 1e-4}, turn);
  const Vec3 normal = turn.col(2);
  Model triangle;
  triangle.ground.vertices = {Vec3f::Zero(), turn.col(0).cast<float>(), turn.col(1).cast<float>()};
  triangle.ground.triangles = {{0, 1, 2}};
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0.6, 0, -0.8), Vec3(0.36, -0.48, 0.8)}) {
    EXPECT_NEAR(incidence_cosine(flat, 0, d), std::abs(normal.dot(d)), 0.003);
    EXPECT_NEAR(incidence_cosine(triangle, 0, d), std::abs(normal.dot(d)), 1e-6);
  }
}

}  // namespace
}  // namespace underbrush::elements
