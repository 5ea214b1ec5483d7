/// \file
/// Why no beam of a simulation meets anything.
#pragma once
#include <string>

#include "underbrush/metrics/bounds.hpp"

namespace underbrush::pipeline {

/// Says in one line where the sensor and the world lie, and what keeps all beams from meeting it:
/// other coordinates (more than 10 km apart), a distance beyond the range (m), or directions. Both
/// boxes are in world coordinates (m), and the world's may be empty.
std::string why_nothing_is_hit(const metrics::Bounds& sensor, const metrics::Bounds& world,
                               double max_range_m);

/// Says where the sensor and the world lie if they are so far apart that their coordinates must be
/// of different systems; else nothing.
std::string other_coordinates(const metrics::Bounds& sensor, const metrics::Bounds& world);

}  // namespace underbrush::pipeline
