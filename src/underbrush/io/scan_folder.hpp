/// \file
/// Folders with one file for each scan, and their poses and times.
#pragma once
#include <filesystem>
#include <optional>

#include "underbrush/io/open_log.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

/// The file of a scan.
struct ScanFile {
  std::filesystem::path path;
  std::filesystem::path labels;  ///< SemanticKITTI .label file; empty if there is none.
  uint32_t frame = 0;            ///< From the name, or else the position in the order of names.
  std::optional<double> time_s;  ///< s; from the name.
};

/// Describes one file. Frame number and time come from its name, as `list_scans` reads them; else
/// they are 0 and none.
ScanFile scan_file(const std::filesystem::path& path);

/// Lists the point files of a folder in order of number or name. Hidden files, whose names begin
/// with a dot, are none: macOS keeps its attributes there, as "._NAME". A name of at most nine
/// digits, or of ten beginning with 0, is a frame number; "SECONDS_FRACTION", "SECONDS.FRACTION"
/// and 19 digits (ns) are times. Throws `FormatError` where there is no file, or a number occurs
/// twice.
std::vector<ScanFile> list_scans(const std::filesystem::path& folder);

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
};

/// Joins the files with their poses and times into a source. Sets `scans`, `scan_infos`, `clock`,
/// `skipped` and `read_notes` of `input` and adds to its `notes`. An empty file of a folder is an
/// empty scan, and counted. The clock is fitted to the times of all scans (`fit_scan_clock`), also
/// those that are not selected; poses that have the scans' times get the clock's where their motion
/// shows that they follow it (`poses_follow_clock`). Throws `FormatError` where a selected scan has
/// no pose or no time.
void place_scans(std::vector<ScanFile> files, const ScanPlacing& placing, Input& input);

}  // namespace underbrush::io
