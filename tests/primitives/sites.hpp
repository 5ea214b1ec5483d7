/// \file
/// This file makes small sites for the tests of this module.
#pragma once
#include <cmath>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::test {

/// Adds `n` points in a cone that stands on its base, or that hangs from `low`.
inline void add_cone(std::vector<Vec3f>& points, double x, double y, double radius, double low,
                     double high, size_t n, Stream& random) {
  for (size_t k = 0; k < n; ++k) {
    const double up = std::cbrt(random.uniform());  // more points where the cone is wide
    const double r = radius * up * std::sqrt(random.uniform());
    const double a = random.uniform(0, 2 * M_PI);
    points.emplace_back(float(x + r * std::cos(a)), float(y + r * std::sin(a)),
                        float(high - up * (high - low)));
  }
}

/// Makes a plane z = a x + b y of two triangles over [−side, side]².
inline elements::Model plane(double side, double a, double b) {
  elements::Model m;
  m.origin = Vec3(10, -20, 3);
  const auto at = [&](double x, double y) {
    return Vec3f(float(x), float(y), float(a * x + b * y));
  };
  m.ground.vertices = {at(-side, -side), at(side, -side), at(side, side), at(-side, side)};
  m.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.ground.hit.resize(2);
  return m;
}

/// Makes a log of the points with their classes and instances. Each point is seen from 10 m above
/// it.
inline BeamLog labelled_log(const std::vector<Vec3>& points, const std::vector<uint8_t>& label,
                            const std::vector<uint32_t>& instance) {
  BeamLog log;
  log.info.classes = "underbrush";
  log.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    log.origin[i] = points[i] + Vec3(0, 0, 10);
    log.direction[i] = Vec3f(0, 0, -1);
    log.range_m[i] = 10;
  }
  log.extra["class"] = label;
  log.extra["instance"] = instance;
  return log;
}

}  // namespace underbrush::test
