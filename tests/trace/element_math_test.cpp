#include "underbrush/trace/element_math.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"
#include "underbrush/trace/exact.inl"

namespace underbrush::trace {
namespace {

TEST(Approach, IsTheMinimumOfTheMahalanobisDistanceAlongTheRay) {
  Stream random(4);
  for (int i = 0; i < 500; ++i) {
    elements::Ellipsoid e;
    for (int k = 0; k < 3; ++k) e.mean[k] = float(random.uniform(-9, 9));
    e.set_covariance(random_covariance(random, 0.02, 2));
    Ray ray;
    for (int k = 0; k < 3; ++k) ray.direction[k] = random.normal();
    ray.direction.normalize();
    const Intersection m = approach(ray.origin, ray.direction, e.mean, e.covariance);
    const Mat3 inverse = e.covariance_matrix().inverse();
    const auto distance2 = [&](double t) {
      const Vec3 r = ray.at(t) - e.mean.cast<double>();
      return r.dot(inverse * r);
    };
    const double scale = 1 + distance2(m.t_m);
    EXPECT_NEAR(m.delta2, distance2(m.t_m), 1e-7 * scale);
    // The Gaussian along the ray has δ²(t) = δ² + (t − t_i)²/σ².
    EXPECT_NEAR(distance2(m.t_m + 2 * m.sigma_m), m.delta2 + 4, 1e-6 * scale);
  }
}

TEST(Opacity, IsTheClosedFormToItsLastDigits) {
  Stream random(5);
  for (int i = 0; i < 20000; ++i) {
    const double x = -std::exp(random.uniform(-40, 6));
    EXPECT_NEAR(Exponential(x).less_one() / std::expm1(x), 1, 2e-15) << x;
    EXPECT_NEAR(Exponential(x).value() / std::exp(x), 1, 2e-15) << x;
  }
  EXPECT_EQ(Exponential(0.0).less_one(), 0);
  for (int i = 0; i < 20000; ++i) {
    const double kappa = std::exp(random.uniform(-9, 9)), sigma = std::exp(random.uniform(-6, 2));
    const double delta2 = random.uniform(0, 16);
    const double p = -std::expm1(-kappa * std::sqrt(2 * M_PI) * sigma * std::exp(-delta2 / 2));
    EXPECT_NEAR(opacity_of(kappa, sigma, delta2) / p, 1, 1e-14);
  }
}

TEST(Crossing, OfATriangleIsTheRangeToItsPlane) {
  Stream random(6);
  int crossed = 0;
  for (int i = 0; i < 4000; ++i) {
    Vec3f p[3];
    for (Vec3f& v : p) {
      for (int k = 0; k < 3; ++k) v[k] = float(random.normal());
    }
    const Vec3 o(random.normal(), random.normal(), random.normal() - 5);
    const Vec3 d = Vec3(random.normal() * 0.2, random.normal() * 0.2, 1).normalized();
    const auto t = crossing(o, d, p[0], p[1], p[2]);
    EXPECT_EQ(t.has_value(), crossing(o, d, p[2], p[1], p[0]).has_value());
    if (!t) continue;
    ++crossed;
    const Vec3 a = p[0].cast<double>();
    const Vec3 n = (p[1].cast<double>() - a).cross(p[2].cast<double>() - a);
    EXPECT_NEAR((o + *t * d - a).dot(n.normalized()), 0, 1e-9);
  }
  EXPECT_GT(crossed, 100);
}

TEST(Meet, ARoughTriangleSpreadsTheRangeByTheAngleOfIncidence) {
  elements::Model model;
  model.ground.vertices = {{-500, -500, 0}, {500, -500, 0}, {0, 500, 0}};
  model.ground.triangles = {{0, 1, 2}};
  model.ground.hit.resize(1);
  model.ground.range_sigma_m = 0.03;
  model.ground.roughness_m = 0.04;
  for (const double cosine : {1.0, 0.5, 0.1, 0.011, 0.005}) {
    const Vec3 d(std::sqrt(1 - cosine * cosine), 0, -cosine);
    const Intersection met = intersect(model, 0, Vec3(0, 0, 1), d, {0, 1000});
    ASSERT_FALSE(met.none());
    const double rise = 0.04 / std::max(cosine, 0.01);
    EXPECT_NEAR(met.sigma_m, std::sqrt(0.03 * 0.03 + rise * rise), 1e-9 * rise / cosine);
    model.ground.roughness = {0.125f};
    const Intersection own = intersect(model, 0, Vec3(0, 0, 1), d, {0, 1000});
    EXPECT_NEAR(own.sigma_m, std::hypot(0.03, rise * 0.125 / 0.04), 1e-8 * rise / cosine);
    model.ground.roughness.clear();
  }
}

}  // namespace
}  // namespace underbrush::trace
