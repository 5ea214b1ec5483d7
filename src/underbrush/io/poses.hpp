/// \file
/// Readers of pose files: TUM, KITTI, and KITTI's GPS/INS (OXTS).
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// Poses in the order of a file.
struct PoseList {
  std::vector<Pose> pose;
  std::vector<double> time_s;  ///< s; as long as `pose`; empty where the format has no times.
  /// Whether `time_s` are whole numbers that may be those of the scans, as in KITTI-360.
  bool numbered = false;
  std::vector<std::string> notes;  ///< Assumptions of the reader, one line each.
};

/// Reads a file of poses. The format follows from the number of columns: 8 is TUM (t tx ty tz qx qy
/// qz qw), 12 is KITTI (row-major 3×4), 13 is a time followed by KITTI's. A line above the rows
/// that names time, position and quaternion gives their order, among any number of columns. Times
/// that are dates in ms, µs or ns become s. Throws `FormatError` for other rows, for quaternions
/// whose length is not 1 within 0.005, for matrices that are not rotations within 0.005, and for a
/// time that occurs twice.
PoseList read_poses(const std::filesystem::path& path);

/// Reads a file of poses with times as a trajectory; from a log (.ply, .ublog), the poses of its
/// scans. Throws `FormatError` where there are no times or no poses.
Trajectory read_trajectory(const std::filesystem::path& path);

/// Returns the rigid transform that 12 numbers (row-major 3×4) describe; nothing if they are not
/// one within 0.005.
std::optional<Pose> pose_from_rows(const std::array<double, 12>& rows);

/// Turns times that are dates from 2001 on in ms, µs or ns into s. Returns what they were, such as
/// "ns since 1970"; "" for all others, which stay.
std::string use_dates(std::vector<double>& times);
/// Says from when to when the poses are (s) among which one for this time is missing, and what
/// clock they may have instead of its own.
std::string times_of_poses(double time_s, double first_s, double last_s);

/// Reads a file with one time (s) for each line. Throws `FormatError` unless they ascend.
std::vector<double> read_times(const std::filesystem::path& path);
/// Reads a file with one date for each line ("YYYY-MM-DD hh:mm:ss.nnnnnnnnn") as seconds since
/// 1970. A blank line between two dates stands for a scan that is missing, and has a time between
/// theirs. Throws `FormatError` unless they ascend.
std::vector<double> read_dates(const std::filesystem::path& path);

/// Reads the numbers of the line "KEY: numbers…" of a KITTI calibration file. Returns nothing if
/// the file or the key does not exist.
std::optional<std::vector<double>> read_calibration(const std::filesystem::path& path,
                                                    const std::string& key);

}  // namespace underbrush::io
