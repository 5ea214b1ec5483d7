/// \file
/// Checks of an imported scan for impossible values.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// Returns the number of different times of a scan's points where it is too small to give
/// the motion within the scan: at most 8 for 100 points and more, as those of zeros and of dates in
/// 32-bit floats. 0 otherwise.
size_t coarse_times(const PointScan& scan);

/// Returns a warning where twenty and a hundredth of a scan's returns lie at its greatest range to
/// 1e-5 of it and 1 mm, as simulators store beams without a return, unless that is `max_range_m`,
/// which makes them misses, or they are one circle below the sensor, as its last ring on flat
/// ground; else "".
std::string warning_of_greatest_range(const PointScan& scan, double max_range_m);

/// Returns a warning where half of a scan's returns are farther than 500 m, or than 100 m with
/// whole numbers as coordinates, as those of a scan in mm or cm are, unless most lie far below or
/// above the sensor; else "".
std::string warning_of_ranges(const PointScan& scan);

/// Returns a warning where the azimuths of a scan turn against `turn` (+1 or −1, the sign of the
/// azimuth's change) as the times of its points rise, evenly through half a revolution and more;
/// else "".
std::string warning_of_turn(const PointScan& scan, double turn);

}  // namespace underbrush::pipeline
