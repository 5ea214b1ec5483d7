/// \file
/// A site with a car that comes or goes, fits of drives past it, and how models are compared, for
/// tests of `update`.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drive_past.hpp"
#include "underbrush/update/update.hpp"

namespace underbrush::update {

inline const Vec3 kCar(3, 7, 0.9);

/// A box on the ground about `kCar`.
inline elements::TriangleMesh car() {
  elements::TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    const Vec3 half(k & 1 ? 1.8 : -1.8, k & 2 ? 0.8 : -0.8, k & 4 ? 0.7 : -0.7);
    mesh.vertices.push_back((kCar + half).cast<float>());
  }
  mesh.triangles = {{0, 1, 5}, {0, 5, 4}, {2, 3, 7}, {2, 7, 6}, {0, 2, 6},
                    {0, 6, 4}, {1, 3, 7}, {1, 7, 5}, {4, 5, 7}, {4, 7, 6}};
  mesh.hit.resize(mesh.size());
  mesh.range_sigma_m = 0.02;
  return mesh;
}

/// Ground, a permeable bush and a dense one, and a parked car where there is one.
inline elements::Model site(bool with_car) {
  elements::Model truth = test::flat_ground(60);
  test::add_bush({-4, -8, 1.2f}, {0.3, 0.3, 0.2}, 0.5f, truth);
  test::add_bush({-8, 10, 1.2f}, {0.3, 0.3, 0.2}, 0.95f, truth);
  if (with_car) truth.surface = car();
  return truth;
}

inline BeamLog drive(bool with_car, uint64_t seed, size_t beams) {
  return test::drive_past(site(with_car), seed, beams, 3000, -0.4);
}

inline BeamLog joined(const BeamLog& a, const BeamLog& b) {
  BeamLog out = a;
  out.append(b, 0, b.size());
  return out;
}

inline fit::FitOptions small_tiles(const std::string& fitter = "likelihood") {
  fit::FitOptions options;
  options.fitter = fitter;
  options.tiles.tile_m = 12;
  return options;
}

inline fit::FitResult fitted(const BeamLog& log, const fit::FitOptions& options = small_tiles()) {
  MemorySource source(log);
  return fit::fit(source, options);
}

inline constexpr UpdateOptions kAtOnce{0, 0};

inline UpdateResult updated(fit::FitResult known, const std::vector<const BeamLog*>& logs,
                            const BeamLog& more, const UpdateOptions& refitting,
                            size_t chunk = 1 << 20,
                            const fit::FitOptions& options = small_tiles()) {
  std::vector<MemorySource> sources;
  sources.reserve(logs.size());
  std::vector<BeamSource*> given;
  for (const BeamLog* log : logs) {
    sources.emplace_back(*log, chunk);
    given.push_back(&sources.back());
  }
  MemorySource added(more, chunk);
  return update(std::move(known), given, added, options, refitting);
}

inline fit::FitResult as_fit(const UpdateResult& u) { return {u.model, {}, u.record, {}}; }

inline bool same(const elements::Ellipsoid& a, const elements::Ellipsoid& b) {
  return a.mean == b.mean && a.covariance == b.covariance && a.hit.hits == b.hit.hits &&
         a.hit.misses == b.hit.misses && a.hit.p == b.hit.p;
}

inline void expect_same_ellipsoids(const elements::Model& a, const elements::Model& b) {
  ASSERT_EQ(a.ellipsoids.size(), b.ellipsoids.size());
  for (size_t i = 0; i < a.ellipsoids.size(); ++i) {
    ASSERT_TRUE(same(a.ellipsoids[i], b.ellipsoids[i])) << i;
  }
}

inline void expect_same_ground(const elements::TriangleMesh& a, const elements::TriangleMesh& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

/// The chance that a beam from the drive's middle to a place ends on an ellipsoid.
inline double opacity_towards(const elements::Model& model, const Vec3& target) {
  const trace::World world(model);
  const Vec3 origin(0, 0, 1.8);
  std::vector<trace::Intersection> met;
  world.all_intersections({origin, (target - origin).normalized()}, {0, 30}, 30, met);
  double through = 1;
  for (const auto& m : met) {
    if (model.kind(m.element) == elements::Kind::kEllipsoid) through *= 1 - m.p;
  }
  return 1 - through;
}

/// The mean of `opacity_towards` places around one.
inline double mean_opacity(const elements::Model& model, const Vec3& target) {
  double sum = 0;
  for (int k = 0; k < 25; ++k) {
    sum += opacity_towards(model, target + Vec3(0.1 * (k % 5 - 2), 0, 0.1 * (k / 5 - 2)));
  }
  return sum / 25;
}

inline size_t ellipsoids_of_car(const elements::Model& model) {
  return size_t(std::count_if(model.ellipsoids.begin(), model.ellipsoids.end(), [&](const auto& e) {
    const Vec3 from = e.mean.template cast<double>() + model.origin - kCar;
    return std::abs(from.x()) < 2.5 && std::abs(from.y()) < 1.5 && from.z() > -0.5;
  }));
}

}  // namespace underbrush::update
