/// A log for the tests of the server.
#pragma once
#include <cmath>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::serve {

/// A hilly ground with poles, seen from above, every tenth beam a miss; seed 7.
inline BeamLog hills(size_t beams, double side_m) {
  Stream random(7);
  BeamLog log;
  log.info.classes = "underbrush";
  log.info.max_range_m = 500;
  log.info.has_misses = true;
  log.resize(beams);
  std::vector<uint8_t> label(beams), echo(beams, 1);
  for (size_t i = 0; i < beams; ++i) {
    const double x = random.uniform(0, side_m), y = random.uniform(0, side_m);
    const bool pole = random.below(20) == 0;
    log.origin[i] = Vec3(1000 + x, -2000 + y, 100);
    log.direction[i] = Vec3f(0, 0, -1);
    const double z = 3 * std::sin(x / 9) * std::cos(y / 7) + (pole ? random.uniform(0, 8) : 0.0);
    if (i % 10 != 0) log.range_m[i] = float(100 - z);
    log.intensity[i] = log.is_hit(i) ? float(random.below(256)) : 0;
    log.time_s[i] = 1.5e9 + 1e-5 * double(i);
    log.ring[i] = uint16_t(i % 32);
    log.scan[i] = uint32_t(i / 5000);
    label[i] = pole ? 8 : 1;
    echo[i] = log.is_hit(i) ? 1 : 0;
  }
  log.extra["class"] = label;
  log.extra[kEchoColumn] = echo;
  return log;
}

}  // namespace underbrush::serve
