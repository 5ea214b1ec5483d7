/// \file
/// Checks of an imported log for impossible values, a sign of wrong conventions of its files.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::pipeline {

/// Throws `FormatError`, naming `source`, where a scan cannot come from a spinning sensor: more
/// rings than channels; a fifth of the returns two degrees and more beyond its elevations, or
/// beyond 1.5 of its range; or returns between channels 0.8° and more apart that do not lie about
/// them (fewer than 65 % in the nearer half of the gap, where chance has 50 %). Scans of fewer than
/// 100 returns are let pass. `option` is the one that names the sensor.
void check_sensor_of(const std::string& source, const std::string& option, const PointScan& scan,
                     const sensor::Sensor& sensor);

/// Returns the number of different times of a scan's points where it is too small to tell the
/// motion within the scan: at most 8 for 100 points and more, as those of zeros and of dates in
/// 32-bit floats. 0 otherwise.
size_t coarse_times(const PointScan& scan);

/// Throws `FormatError`, naming `source`, where misses of a sensor would be inferred for a scan
/// that cannot have been made by all of its channels: three and a fifth of those between the lowest
/// and the highest with returns have none, though the nearest ones above and below have many, and
/// so at all errors of the elevations within 0.5° of `fault_rad`. Scans whose numbers of rings are
/// the sensor's (`sensor::rings_are_channels`) may lack any rings.
void check_channels_of(const std::string& source, const std::string& option, const PointScan& scan,
                       const sensor::Sensor& sensor, double fault_rad);

/// Returns a warning where twenty and a hundredth of a scan's returns lie at its greatest range to
/// 1e-5 of it and 1 mm, as simulators store beams without a return, unless that is `max_range_m`,
/// which makes them misses; else "".
std::string warning_of_greatest_range(const PointScan& scan, double max_range_m);

/// Returns a warning where half of a scan's returns are farther than 1 km, as those of a scan in
/// millimetres are, else "".
std::string warning_of_ranges(const PointScan& scan);

/// Returns warnings about the poses of scans, each with its likely cause: speeds beyond 100 m/s,
/// a motion that is mostly up or down, and sensors that lie on their side or stand on their head
/// but would be upright with w as the first number of the quaternions.
std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans);

/// Compares up to four pairs of scans, between which the sensor moved by a metre or turned by ten
/// degrees: the share of the upper half of one scan's points that lie in cells (0.4 m) of the
/// other's. Returns a warning where the poses as they are give less than 0.4 and one of these gives
/// 0.2 more: their inverses (sensor from world), their quaternions with w first, or, if they are
/// more than 5 m apart from scan to scan, their positions in mm. Returns "" without such a finding.
/// Reads the scans of the pairs.
std::string warning_of_overlap(ScanSource& scans, const std::vector<ScanInfo>& infos);

}  // namespace underbrush::pipeline
