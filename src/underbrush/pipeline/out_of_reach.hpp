/// \file
/// The reason for which no beam of a simulation meets anything.
#pragma once
#include <string>

#include "underbrush/metrics/bounds.hpp"

namespace underbrush::pipeline {

/// Returns one line with the places of the sensor and of the world, and the reason for the misses:
/// other coordinates (more than 10 km apart), a distance beyond the range (m), or directions. Both
/// boxes are in world coordinates (m), and the world's may be empty.
std::string why_nothing_is_hit(const metrics::Bounds& sensor, const metrics::Bounds& world,
                               double max_range_m);

/// Returns the places of the sensor and of the world if they are so far apart that their
/// coordinates must be of different systems; else nothing.
std::string other_coordinates(const metrics::Bounds& sensor, const metrics::Bounds& world);

/// Returns one line with the places of the sensor and of the ground if all ground of a scene is so
/// far away, whatever else is near; else nothing.
std::string ground_elsewhere(const metrics::Bounds& sensor, const elements::Scene& scene);

}  // namespace underbrush::pipeline
