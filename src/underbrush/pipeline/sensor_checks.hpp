/// \file
/// Checks whether an imported scan can come from a sensor.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::pipeline {

/// Throws `FormatError`, naming `source`, where a scan cannot come from a spinning sensor: more
/// rings than channels; 8 % of the returns two degrees and more beyond its elevations, or a fifth
/// beyond 1.5 of its range; or returns between channels 0.8° and more apart that do not lie about
/// them (fewer than 65 % in the nearer half of the gap, where chance has 50 %). Scans of fewer than
/// 100 returns are let pass. `option` is the one that names the sensor.
void check_sensor_of(const std::string& source, const std::string& option, const PointScan& scan,
                     const sensor::Sensor& sensor);

/// Throws `FormatError`, naming `source`, where misses of a sensor would be inferred for a scan
/// that cannot have been made by all of its channels: three and a fifth of those between the lowest
/// and the highest with returns have none, though the nearest ones above and below have many, and
/// so at all errors of the elevations within 0.5° of `fault_rad`. Scans whose numbers of rings are
/// the sensor's (`sensor::rings_are_channels`) may lack any rings.
void check_channels_of(const std::string& source, const std::string& option, const PointScan& scan,
                       const sensor::Sensor& sensor, double fault_rad);

}  // namespace underbrush::pipeline
