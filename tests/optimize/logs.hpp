/// Logs for the tests of the tuning.
#pragma once
#include "underbrush/core/rng.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::test {

/// `scans` turns of a sensor that drives past two permeable bushes on flat ground, one a second.
inline BeamLog drive_past_bushes(uint64_t seed, uint32_t scans, size_t beams_of_scan = 1500) {
  elements::Model truth;
  truth.tau = 3;
  truth.ground.vertices = {{-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0}};
  truth.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  truth.ground.hit.resize(2);
  truth.ground.range_sigma_m = 0.02;
  for (int k = 0; k < 24; ++k) {
    elements::Ellipsoid e;
    e.mean = Vec3f(-6 + 0.5f * float(k), k % 2 ? 6.0f : -6.0f, 0.4f + 0.2f * float(k % 5));
    e.set_covariance(Vec3(0.05, 0.05, 0.03).asDiagonal());
    e.hit.p = k % 2 ? 0.9f : 0.4f;
    truth.ellipsoids.push_back(e);
  }
  BeamLog log;
  log.info.max_range_m = 50;
  log.info.min_range_m = 0.5;
  log.info.has_misses = true;
  Stream random(seed);
  log.resize(scans * beams_of_scan);
  for (size_t i = 0; i < log.size(); ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), elevation = random.uniform(-0.3, 0.1);
    log.scan[i] = uint32_t(i / beams_of_scan);
    log.time_s[i] = 100 + double(i) / double(beams_of_scan);
    log.packet[i] = uint32_t(i / 50);
    log.origin[i] = Vec3(-6 + 12 * double(i) / double(log.size()), 0, 1.8);
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
