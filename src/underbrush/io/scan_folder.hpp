/// \file
/// Folders with one file for each scan, and their poses and times.
#pragma once
#include <filesystem>
#include <optional>

#include "underbrush/io/open_log.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/scan_names.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

/// Poses and times of the scans of a folder.
struct ScanPlacing {
  PoseList poses;                    ///< By frame number where they have no times.
  std::string poses_name;            ///< File of the poses, for error messages.
  std::vector<double> times;         ///< s, by frame number; empty if unknown.
  std::string times_name;            ///< File of the times, for error messages.
  bool points_in_world = false;      ///< The points are in the world frame, else in the sensor's.
  FrameRange frames;                 ///< Scans to read, by number.
  bool fit_clock = false;            ///< Whether rounded times of scans get a steady clock.
  std::vector<std::string> columns;  ///< Names of the columns of files that have none.
  double unit_m = 1;                 ///< Unit of the points' coordinates, m.
  double period_s = 0;               ///< Time between scans, s, if there are no times.
  TimesCount count = TimesCount::kAfter;  ///< How times of points count.
};

/// Joins the files with their poses and times into a source. Sets `scans`, `scan_infos`, `clock`,
/// `skipped` and `read_notes` of `input` and adds to its `notes`. An empty file of a folder is an
/// empty scan, and counted. The clock is fitted to the times of all scans (`fit_scan_clock`), also
/// those that are not selected; poses that have the scans' times get the clock's where their motion
/// shows that they follow it (`poses_follow_clock`). Where there are more rows of poses or times
/// than scans, scans take those that a number in their names counts. Times in ms, µs or ns become
/// s. Scans in gaps of the poses (`split_at_gaps`) are left out and counted. Throws `FormatError`
/// where a selected scan has no pose or no time.
void place_scans(std::vector<ScanFile> files, ScanPlacing placing, Input& input);

}  // namespace underbrush::io
