/// \file
/// Checks of the poses of an imported log, for signs of wrong conventions of its files.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// Returns warnings about the poses of scans, each with its likely cause: speeds beyond 100 m/s,
/// a motion that is mostly up or down, and sensors that lie on their side or stand on their head
/// but would be upright with w as the first number of the quaternions.
std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans);

/// Whether most sensors are tilted by more than 37°, as few are.
bool are_tilted(const std::vector<ScanInfo>& scans);

/// Returns a warning about poses that do not fit the scans, or "".
///
/// If sensors are tilted, takes up to four scans, and warns where the ground is level in the
/// sensor's frame but steep or above the sensor in the world: of the neighbouring cells (1 m,
/// within 20 m), 0.4 have lowest points below the sensor that differ by less than 0.3 m without
/// the rotations of the poses, and with them at most half as many do.
///
/// Compares up to four pairs of scans, between which the sensor moved by a metre or turned by ten
/// degrees: the share of the upper half of one scan's points that lie in cells (0.4 m) of the
/// other's. Warns where the poses as they are give less than 0.4 and one of these gives
/// 0.2 more: their inverses (sensor from world), their quaternions with w first, or, if they are
/// more than 5 m apart from scan to scan, their positions in mm.
std::string warning_of_scans(ScanSource& scans, const std::vector<ScanInfo>& infos);

}  // namespace underbrush::pipeline
