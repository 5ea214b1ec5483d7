/// \file
/// This file makes level ground and random beams above it, for the tests of the likelihood.
#pragma once
#include <array>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::test {

/// Makes level ground, 120 m wide, of a roughness in metres.
inline elements::TriangleMesh level_ground(double roughness_m) {
  elements::TriangleMesh ground;
  ground.vertices = {{-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}};
  ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  ground.hit.resize(2);
  ground.range_sigma_m = 0.01;
  ground.roughness_m = roughness_m;
  return ground;
}

/// The intervals from which beams are drawn evenly.
struct BeamSpread {
  std::array<double, 2> azimuth_rad, elevation_rad;
  std::array<double, 2> x_m, y_m;  ///< The origins, relative to a place.
};

/// Makes beams without outcomes, fired 1.5 m above `at` in 20 scans of packets of 100.
inline BeamLog random_beams(uint64_t seed, size_t n, const BeamSpread& spread,
                            const Vec3& at = Vec3::Zero()) {
  BeamLog log;
  log.info.max_range_m = 40;
  log.info.min_range_m = 0.2;
  log.info.has_misses = true;
  log.resize(n);
  Stream random(seed);
  const auto draw = [&](const std::array<double, 2>& from) {
    return random.uniform(from[0], from[1]);
  };
  for (size_t i = 0; i < n; ++i) {
    const double azimuth = draw(spread.azimuth_rad), elevation = draw(spread.elevation_rad);
    const double y = draw(spread.y_m), x = draw(spread.x_m);
    log.origin[i] = at + Vec3(x, y, 1.5);
    log.direction[i] = Vec3(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                           .cast<float>();
    log.scan[i] = uint32_t(i * 20 / n);
    log.packet[i] = uint32_t(i / 100);
  }
  return log;
}

/// Answers beams by a model.
inline BeamLog answered(BeamLog log, const elements::Model& model, uint64_t seed) {
  simulate::Options options;
  options.seed = seed;
  simulate::simulate(trace::World(model), options, 0, log);
  return log;
}

}  // namespace underbrush::test
