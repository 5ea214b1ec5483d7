/// \file
/// The reasons for which no beam of a simulation meets anything, and signs of wrong units.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"
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

/// Returns a warning about a world that is more than 200 m and a third of its width high, as those
/// in millimetres are, or more than 30 m high and less than a quarter of that and of its extent in
/// x wide in y, as those whose y axis points up; else "".
std::string larger_than_life(const metrics::Bounds& world);

/// Returns warnings about a trajectory on which the median speed is more than 400 m/s, or whose
/// quaternions seem to have w first (`warning_of_tilt`).
std::vector<std::string> warnings_of_path(const Trajectory& path);

}  // namespace underbrush::pipeline
