/// \file
/// Poses of a drive in the layout of KITTI's raw data.
#pragma once
#include <filesystem>

#include "underbrush/io/poses.hpp"

namespace underbrush::io {

/// Poses of a KITTI raw drive, and whether they are those of the lidar.
struct OxtsPoses {
  PoseList poses;
  bool calibrated = false;  ///< World from velodyne if true, else world from INS.
};

/// Reads the poses of a KITTI raw drive from FOLDER/oxts/data/*.txt (lat lon alt roll pitch yaw …),
/// by the Mercator projection of KITTI's development kit at the scale of the first latitude. In the
/// world x points east, y north and z up; its origin is the first INS position. If
/// calib_imu_to_velo.txt lies in FOLDER or above it, the poses are world from velodyne, else world
/// from INS. The times are those of FOLDER/oxts/timestamps.txt: as many as there are files, or one
/// for each number that a file may have. Without it a pose is that of the scan with the number of
/// its file. Throws `FormatError`, also for a number without a file where the numbers count, and
/// for angles of more than a revolution in radians.
OxtsPoses read_oxts(const std::filesystem::path& folder);

}  // namespace underbrush::io
