// This file makes random and adversarial scenes for the tracing tests.
#pragma once
#include <Eigen/Geometry>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

inline Mat3 random_covariance(Stream& random, double smallest, double largest) {
  const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
  const Mat3 r = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  Vec3 s;
  for (int k = 0; k < 3; ++k) {
    s[k] = std::exp(random.uniform(std::log(smallest), std::log(largest)));
  }
  return r * s.cwiseAbs2().asDiagonal() * r.transpose();
}

/// Makes ellipsoids from needles to discs, some of them twice, over a bumpy permeable ground, with
/// some loose surface triangles.
inline elements::Model random_model(uint64_t seed, int ellipsoids = 300,
                                    const Vec3& origin = {0, 0, 0}) {
  Stream random(seed);
  elements::Model model;
  model.origin = origin;
  model.tau = random.uniform(1.5, 4);
  for (int i = 0; i < ellipsoids; ++i) {
    elements::Ellipsoid e;
    for (int k = 0; k < 3; ++k) e.mean[k] = float(random.uniform(-20, 20));
    e.mean[2] = std::abs(e.mean[2]);
    e.set_covariance(random_covariance(random, 0.005, 1.0));
    e.hit.p = float(random.uniform() < 0.1 ? (random.uniform() < 0.5 ? 0 : 1) : random.uniform());
    model.ellipsoids.push_back(e);
    if (i % 10 == 0) model.ellipsoids.push_back(e);  // coincident
  }
  const int n = 12;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      model.ground.vertices.emplace_back(float(i * 4 - 24), float(j * 4 - 24),
                                         float(random.uniform(-1, 0)));
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const uint32_t a = uint32_t(i * (n + 1) + j), b = a + n + 1;
      model.ground.triangles.push_back({a, b, b + 1});
      model.ground.triangles.push_back({a, b + 1, a + 1});
    }
  }
  for (int i = 0; i < 50; ++i) {
    const uint32_t at = uint32_t(model.surface.vertices.size());
    Vec3f centre;
    for (int k = 0; k < 3; ++k) centre[k] = float(random.uniform(-20, 20));
    for (int v = 0; v < 3; ++v) {
      Vec3f p = centre;
      for (int k = 0; k < 3; ++k) p[k] += float(random.normal());
      model.surface.vertices.push_back(p);
    }
    model.surface.triangles.push_back({at, at + 1, at + 2});
  }
  model.ground.range_sigma_m = 0.03;
  model.surface.range_sigma_m = 0.02;
  model.ground.roughness_m = 0.01;
  for (elements::TriangleMesh* mesh : {&model.ground, &model.surface}) {
    for (size_t i = 0; i < mesh->size(); ++i) {
      mesh->hit.push_back({float(random.uniform() < 0.5 ? 1 : random.uniform()), 0, 0});
    }
  }
  for (size_t i = 0; i < model.ground.size(); ++i) {  // its triangles have their own, others none
    model.ground.roughness.push_back(i % 3 ? float(random.uniform(0, 0.05)) : 0.0f);
  }
  model.check();
  return model;
}

/// Makes a ray from around or inside the model. Some run along axes, and some graze an element.
inline Ray random_ray(Stream& random, const elements::Model& model) {
  Ray ray;
  for (int k = 0; k < 3; ++k) ray.origin[k] = random.uniform(-25, 25);
  Vec3 d;
  for (int k = 0; k < 3; ++k) d[k] = random.normal();
  const double kind = random.uniform();
  if (kind < 0.1) {
    d = Vec3::Unit(int(random.below(3))) * (random.uniform() < 0.5 ? 1 : -1);
  } else if (kind < 0.6 && !model.ellipsoids.empty()) {
    const auto& e = model.ellipsoids[random.below(model.ellipsoids.size())];
    Vec3 side;
    for (int k = 0; k < 3; ++k) side[k] = random.normal();
    // This is about the isosurface as seen from the ray's origin.
    const double r = model.tau * std::sqrt(double(e.covariance[0]));
    if (kind < 0.2) ray.origin = e.mean.cast<double>() + 0.1 * r * side;
    d = e.mean.cast<double>() + r * side.normalized() - ray.origin;
  }
  ray.direction = d.normalized();
  ray.origin += model.origin;
  return ray;
}

}  // namespace underbrush::trace
