/// \file
/// This file converts between directions and their azimuth and elevation.
#pragma once
#include <cmath>

#include "underbrush/core/pose.hpp"

namespace underbrush::sensor {

/// Computes the unit vector at an azimuth (counter-clockwise from x) and an elevation above the x–y
/// plane.
inline Vec3 unit_vector(double azimuth_rad, double elevation_rad) {
  const double flat = std::cos(elevation_rad);
  return {flat * std::cos(azimuth_rad), flat * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

/// Maps an angle to [0, 2π).
inline double positive_angle(double rad) {
  const double a = rad - 2 * M_PI * std::floor(rad / (2 * M_PI));
  return a < 2 * M_PI ? a : 0;
}

/// Maps an angle to [−π, π).
inline double signed_angle(double rad) { return positive_angle(rad + M_PI) - M_PI; }

}  // namespace underbrush::sensor
