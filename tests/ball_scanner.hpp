/// \file
/// A sensor that drives along many balls, and models with keyframes of its logs.
#pragma once
#include <cmath>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/keyframes/keyframes.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::test {

inline constexpr uint16_t kRings = 24;
inline constexpr int kColumns = 500;
inline constexpr double kNoiseM = 0.01;
inline const Vec3 kPlace(411.3, -250, 17);  // where the x axis begins, m, world

inline double uniform(size_t a, uint32_t b) {
  return uniform_from_bits(random_bits(a, b, Purpose::kPlace));
}

struct Ball {
  Vec3 middle;
  double radius;
};

/// Balls of 10 to 40 cm on both sides of the x axis, as crowns of many leaves.
inline std::vector<Ball> balls() {
  std::vector<Ball> out;
  for (uint32_t k = 0; k < 900; ++k) {
    const double side = k % 2 ? 1 : -1;
    out.push_back({kPlace + Vec3(50 * uniform(k, 1) - 20, side * (4 + 14 * uniform(k, 2)),
                                 4 * uniform(k, 5) - 1.5),
                   0.1 + 0.3 * uniform(k, 3)});
  }
  return out;
}

/// The range to the ground, 2 m below the x axis, or to the nearest ball, m.
inline double true_range(const Ray& ray, const std::vector<Ball>& all) {
  const double down = ray.direction.z();
  double nearest = down < 0 ? (kPlace.z() - 2 - ray.origin.z()) / down : HUGE_VAL;
  for (const Ball& ball : all) {
    const Vec3 to = ball.middle - ray.origin;
    const double along = to.dot(ray.direction);
    const double root = ball.radius * ball.radius - to.squaredNorm() + along * along;
    if (root > 0 && along > 0) nearest = std::min(nearest, along - std::sqrt(root));
  }
  return nearest;
}

/// Scans from places on the x axis. The sensor moves by `drift_m` in a scan.
inline BeamLog scanned(const std::vector<double>& at, uint32_t first_scan, double drift_m = 0) {
  const std::vector<Ball> all = balls();
  BeamLog log;
  log.info.sensor = "ball-scanner";
  log.info.has_misses = true;
  log.info.max_range_m = 50;
  log.resize(at.size() * kColumns * kRings);
  size_t i = 0;
  for (size_t s = 0; s < at.size(); ++s) {
    const uint32_t scan = first_scan + uint32_t(s);
    for (int k = 0; k < kColumns; ++k) {
      for (uint16_t ring = 0; ring < kRings; ++ring, ++i) {
        const double azimuth = 2 * M_PI * (k + uniform(scan, 9)) / kColumns;
        const double elevation = (6 - ring) * M_PI / 180;
        log.origin[i] = kPlace + Vec3(at[s] + drift_m * (double(k) / kColumns - 0.5), 0, 0);
        log.direction[i] =
            Vec3f(float(std::cos(elevation) * std::cos(azimuth)),
                  float(std::cos(elevation) * std::sin(azimuth)), float(std::sin(elevation)));
        const double range = true_range(log.ray(i), all) +
                             kNoiseM * normal(mix64(scan), uint32_t(i), Purpose::kNoise);
        log.range_m[i] = range < 50 ? float(range) : kMiss;
        log.intensity[i] = range < 50 ? float(10 + uniform(size_t(azimuth * 40), 4)) : 0;
        log.ring[i] = ring;
        log.scan[i] = scan;
        log.time_s[i] = scan * 0.1;
      }
    }
  }
  return log;
}

inline elements::Model fitted(const BeamLog& log, double spacing_m,
                              size_t most_bytes = size_t(1) << 28) {
  fit::FitOptions options;
  options.fitter = "hierarchical";
  MemorySource source(log);
  elements::Model model = fit::fit(source, options).model;
  keyframes::KeyframeOptions keyframes;
  keyframes.spacing_m = spacing_m;
  keyframes.most_bytes = most_bytes;
  keyframes::learn_keyframes(model, source, keyframes);
  return model;
}

inline BeamLog answered(const elements::Model& model, BeamLog beams, bool element_ids = false) {
  const trace::World world(model);
  simulate::Options options;
  options.element_ids = element_ids;
  simulate::simulate(world, options, 0, beams);
  return beams;
}

inline metrics::Summary scored(const elements::Model& model, const BeamLog& real) {
  const BeamLog simulated = answered(model, real);
  const trace::World world(model);
  metrics::ScoreOptions options;
  options.world = &world;
  MemorySource a(real), b(simulated);
  return metrics::score(a, b, options).all;
}

inline const std::vector<double> kDrive{0, 0.7, 1.4, 2.1, 2.8, 3.5, 4.2, 4.9, 5.6, 6.3};

}  // namespace underbrush::test
