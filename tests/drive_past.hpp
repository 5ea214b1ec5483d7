/// \file
/// This file makes logs of a drive past known bushes.
#pragma once
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::test {

/// Makes flat ground, 2 `half_m` wide about `origin`, with τ = 3.
inline elements::Model flat_ground(float half_m, const Vec3& origin = Vec3::Zero()) {
  elements::Model truth;
  truth.origin = origin;
  truth.tau = 3;
  truth.ground.vertices = {
      {-half_m, -half_m, 0}, {half_m, -half_m, 0}, {half_m, half_m, 0}, {-half_m, half_m, 0}};
  truth.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  truth.ground.hit.resize(2);
  truth.ground.range_sigma_m = 0.02;
  return truth;
}

inline void add_bush(const Vec3f& mean, const Vec3& variance_m2, float p, elements::Model& truth) {
  elements::Ellipsoid e;
  e.mean = mean;
  e.set_covariance(variance_m2.asDiagonal());
  e.hit.p = p;
  truth.ellipsoids.push_back(e);
}

/// Makes the log of a sensor that drives 12 m along x past the origin of `truth`, 1.8 m high.
/// Directions are drawn evenly in azimuth and in elevation from `lowest_rad` to 0.1; a scan lasts a
/// second.
inline BeamLog drive_past(const elements::Model& truth, uint64_t seed, size_t beams,
                          size_t beams_of_scan, double lowest_rad) {
  BeamLog log;
  log.info.max_range_m = 50;
  log.info.min_range_m = 0.5;
  log.info.has_misses = true;
  Stream random(seed);
  log.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), elevation = random.uniform(lowest_rad, 0.1);
    log.scan[i] = uint32_t(i / beams_of_scan);
    log.time_s[i] = 100 + double(i) / double(beams_of_scan);
    log.packet[i] = uint32_t(i / 50);
    log.origin[i] = truth.origin + Vec3(-6 + 12 * double(i) / double(beams), 0, 1.8);
    log.direction[i] = Vec3(std::cos(azimuth) * std::cos(elevation),
                            std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                           .cast<float>();
  }
  const trace::World world(truth);
  simulate::Options options;
  options.seed = seed;
  simulate::simulate(world, options, 0, log);
  return log;
}

}  // namespace underbrush::test
