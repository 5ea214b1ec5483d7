/// \file
/// Files of poses: TUM, KITTI, and KITTI's GPS/INS (OXTS).
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// Poses in the file's order.
struct PoseList {
  std::vector<Pose> pose;
  std::vector<double> time_s;  ///< As long as `pose`; empty where the format has no times.
};

/// Told apart by the number of columns: 8 is TUM (t tx ty tz qx qy qz qw), 12 KITTI (row-major
/// 3×4), 13 a time and then KITTI's. Throws `FormatError` on other rows, quaternions whose length
/// is not 1 within 0.005, matrices that are not rotations within 0.005, and a time given twice.
PoseList read_poses(const std::filesystem::path& path);

/// The poses of a file with times, as a trajectory. Throws `FormatError` where there are no times,
/// or no poses.
Trajectory read_trajectory(const std::filesystem::path& path);

/// The rigid transform in 12 numbers, row-major 3×4; nothing if it is not one within 0.005.
std::optional<Pose> pose_from_rows(const std::array<double, 12>& rows);

/// One number a line. Throws `FormatError` unless they rise.
std::vector<double> read_times(const std::filesystem::path& path);
/// One date a line ("YYYY-MM-DD hh:mm:ss.nnnnnnnnn"), as seconds since 1970. As `read_times`.
std::vector<double> read_dates(const std::filesystem::path& path);

/// A line "KEY: numbers…" of a KITTI calibration file; nothing without the file or the key.
std::optional<std::vector<double>> read_calibration(const std::filesystem::path& path,
                                                    const std::string& key);

/// Poses of a KITTI raw drive.
struct OxtsPoses {
  PoseList poses;
  bool calibrated = false;
};
/// Poses of a KITTI raw drive: FOLDER/oxts/data/*.txt (lat lon alt roll pitch yaw …), the Mercator
/// projection of KITTI's development kit at the scale of the first latitude; world: x east, y
/// north, z up, origin at the first INS position. World from velodyne where calib_imu_to_velo.txt
/// lies in FOLDER or above it, else world from INS (`calibrated` false).
OxtsPoses read_oxts(const std::filesystem::path& folder);

}  // namespace underbrush::io
