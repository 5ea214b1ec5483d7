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
/// which makes them misses; else "".
std::string warning_of_greatest_range(const PointScan& scan, double max_range_m);

/// Returns a warning where half of a scan's returns are farther than 1 km, as those of a scan in
/// millimetres are, else "".
std::string warning_of_ranges(const PointScan& scan);

}  // namespace underbrush::pipeline
