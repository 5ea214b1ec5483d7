// Worlds that tests cut into regions: a model and a scene in which elements lie across borders, and
// a drive through them.
#pragma once
#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/pipeline/world.hpp"

namespace underbrush::test {

using elements::Model;

inline constexpr double kSide = 10;  // m; the side of regions

/// Adds hilly ground over [0, 60] × [0, 40] m, with hit probabilities and roughnesses of its own.
inline void add_ground(Model& model, Stream& random) {
  constexpr uint32_t kX = 31, kY = 21;
  elements::TriangleMesh& mesh = model.ground;
  for (uint32_t k = 0; k < kX * kY; ++k) {
    mesh.vertices.emplace_back(2.F * float(k % kX), 2.F * float(k / kX),
                               float(random.uniform(-0.3, 0.3)));
  }
  for (uint32_t k = 0; k < (kX - 1) * (kY - 1); ++k) {
    const uint32_t a = k / (kX - 1) * kX + k % (kX - 1), b = a + kX;
    mesh.triangles.push_back({a, a + 1, b + 1});
    mesh.triangles.push_back({a, b + 1, b});
  }
  for (size_t k = 0; k < mesh.size(); ++k) {
    mesh.hit.push_back({float(random.uniform(0.6, 1)), 1, 0});
    mesh.roughness.push_back(float(random.uniform(0, 0.05)));
    mesh.light.push_back({float(random.uniform(5, 50)), 1});
  }
  mesh.range_sigma_m = 0.02;
}

inline void add_ellipsoids(Model& model, size_t count, const Vec3& size_m, Stream& random) {
  for (size_t k = 0; k < count; ++k) {
    elements::Ellipsoid e;
    for (int d = 0; d < 3; ++d) e.mean[d] = float(random.uniform(0, size_m[d]));
    const Vec3 sigma(random.uniform(0.02, 0.4), random.uniform(0.02, 0.4), 0.3);
    e.set_covariance(sigma.cwiseAbs2().asDiagonal());
    e.hit.p = float(random.uniform(0.05, 0.6));
    e.label = uint32_t(k % 3);
    if (k % 4 == 0) e.density_per_m = float(random.uniform(0.2, 2));
    e.light = {float(random.uniform(5, 50)), 3};
    model.ellipsoids.push_back(e);
  }
}

/// A model in which every kind of element lies across the borders of regions.
inline Model whole_model() {
  Stream random(1);
  Model model;
  model.origin = Vec3(500007, -304, 12);
  model.tau = 3;
  add_ground(model, random);
  add_ellipsoids(model, 3000, Vec3(60, 40, 5), random);
  elements::TriangleMesh& wall = model.surface;
  wall.vertices = {{3, 20, 0}, {50, 20, 0}, {50, 20, 3}, {3, 20, 3}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.hit = {{0.7F, 1, 0}, {0.8F, 1, 0}};
  wall.light.resize(2);
  model.grain = {0.1, 0.2, {{1, 0.05}}};
  model.range_noise_m = 0.01;
  model.light.max_intensity = 100;
  model.light.range = {{0, 60}, {1, 0.5}};
  for (auto& g : model.light.incidence) g = {{0, 1}, {0.5, 1}};
  return model;
}

/// A scene of the model's ground and of plants, turned and scaled.
inline elements::Scene whole_scene(elements::SceneInfo& info) {
  Stream random(2);
  elements::Scene scene;
  const Model whole = whole_model();
  scene.models.push_back(whole.like());
  scene.models[0].ground = whole.ground;
  for (int k = 0; k < 3; ++k) {
    scene.models.emplace_back();
    add_ellipsoids(scene.models.back(), 60, Vec3(2, 2, 4), random);
  }
  scene.instances.emplace_back().world_from_model.translation = whole.origin;
  for (uint32_t k = 0; k < 200; ++k) {
    elements::Instance& i = scene.instances.emplace_back();
    i.world_from_model.translation =
        whole.origin + Vec3(random.uniform(0, 60), random.uniform(0, 40), 0);
    i.world_from_model.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(-3, 3), Vec3::UnitZ()));
    i.scale = float(random.uniform(0.5, 1.5));
    i.model = 1 + k % 3;
  }
  info.names = {"ground", "a", "b", "c"};
  info.labels.assign(scene.instances.size(), elements::Class::kSmallTree);
  info.labels[0] = elements::Class::kGround;
  return scene;
}

/// The beams of a sensor that drives through the world and over its border.
inline BeamLog drive(const Vec3& origin, size_t beams = 4000) {
  Stream random(3);
  BeamLog log;
  log.info.sensor = "velodyne-hdl32e";
  log.info.max_range_m = 25;
  log.info.min_range_m = 0.5;
  log.info.has_misses = true;
  log.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), elevation = random.uniform(-0.4, 0.1);
    log.time_s[i] = 1e-4 * double(i);
    log.origin[i] = origin + Vec3(-30 + 100 * double(i) / double(beams), 18, 2);
    log.direction[i] = Vec3(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                           .cast<float>();
  }
  return log;
}

/// The world of one model.
inline pipeline::World world_of(Model model) {
  pipeline::World world;
  world.scene.models.push_back(std::move(model));
  return world;
}

/// The same of a scene.
inline pipeline::World world_of_scene() {
  pipeline::World world;
  world.scene = whole_scene(world.info);
  return world;
}

}  // namespace underbrush::test
