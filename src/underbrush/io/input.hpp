/// \file
/// Opens a log of any supported format.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/io/open_log.hpp"

namespace underbrush::io {

/// Parses "A:B", "A:B:STEP", "A:" or ":B" (half-open). Throws `std::invalid_argument` for any other
/// text.
FrameRange frames_from_text(const std::string& text);

/// Options of `open_input`.
struct InputOptions {
  std::string format;            ///< One of `input_formats()`, or empty to detect the format.
  std::filesystem::path poses;   ///< File of poses, TUM or KITTI; empty: the format's own.
  std::filesystem::path times;   ///< File with one time (s) for each line; empty: the format's own.
  std::filesystem::path labels;  ///< SemanticKITTI labels of a single scan; they become the extra
                                 ///< column `class`.
  FrameRange frames;             ///< Scans to read, by number.
  bool points_in_world = false;  ///< The points are in the world frame already; by default they are
                                 ///< in the sensor's.
  bool fit_clock = false;        ///< Whether rounded times of scans get a steady clock.
  std::vector<std::string> columns;  ///< Names of the columns of files that have none.
  double unit_m = 1;                 ///< Unit of the coordinates, m.
  double scan_period_s = 0;          ///< Time between scans, s, where their times do not give it.
  TimesCount count = TimesCount::kAfter;  ///< How times of points count.
};

/// Returns the names of the formats: ray-cloud, compact, csv, scan (one file), kitti
/// (velodyne/NNNNNN.bin), kitti-odometry, kitti-raw, and folder (one file for each scan).
std::vector<std::string> input_formats();

/// Opens a log, which may be packed by gzip if it is one file. docs/reference/formats.md lists the
/// files and their places. Throws `FormatError` where the path is no supported log or a selected
/// scan has no pose or time, and `std::invalid_argument` for an unknown format name.
Input open_input(const std::filesystem::path& path, const InputOptions& options = {});

}  // namespace underbrush::io
