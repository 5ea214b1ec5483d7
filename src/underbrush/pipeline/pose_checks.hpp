/// \file
/// Checks of the poses of an imported log, for signs of wrong conventions of its files.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// Returns warnings about the poses of scans, each with its likely cause: speeds beyond 100 m/s,
/// and a motion that is mostly up or down.
std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans);

/// Returns a warning where most poses have the sensor on its side or its head, and upright with w
/// as the first number of their quaternions; else "".
std::string warning_of_tilt(const std::vector<ScanInfo>& scans);

/// Whether most sensors are tilted by more than 37°, as few are.
bool are_tilted(const std::vector<ScanInfo>& scans);

/// Returns a warning about poses that do not fit the scans, or "".
///
/// Takes up to four scans, and counts the neighbouring cells (1 m, within 20 m) whose lowest points
/// lie below the sensor and differ by less than 0.3 m. Warns where 0.4 of all would be such if the
/// sensor hung upside down, or if tilted sensors were not turned, and at most half as many are by
/// the poses; and where less than 0.4 are, and tilted sensors are upright with w as the first
/// number of the quaternions.
///
/// Compares up to four pairs of scans, between which the sensor moved by a metre or turned by ten
/// degrees: the share of the upper half of one scan's points that lie in cells (0.4 m) of the
/// other's. Warns where the poses as they are give less than 0.4 and one of these gives
/// 0.2 more: their inverses (sensor from world), their quaternions with w first, or, if they are
/// more than 5 m apart from scan to scan, their positions in mm. Where none of them does and the
/// poses as they are give less than 0.6, warns if a level motion of up to 4 m and 10° from a scan
/// to the next, or to the third after it, gives 0.2 more than that by the poses
/// (`best_motion`). A sensor that stands by the poses is also compared 10, 30 and 100 scans later.
/// Nothing is said of scans with fewer than 250 points to compare (`upper_points`).
std::string warning_of_scans(ScanSource& scans, const std::vector<ScanInfo>& infos);

}  // namespace underbrush::pipeline
