/// \file
/// Scans in files, one each, with their poses and times.
#pragma once
#include <filesystem>
#include <optional>

#include "underbrush/io/input.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {

/// A scan's file.
struct ScanFile {
  std::filesystem::path path;
  std::filesystem::path labels;  ///< SemanticKITTI .label; empty = none.
  uint32_t frame = 0;            ///< From its name, or its place in the order of names.
  std::optional<double> time_s;  ///< From its name.
};

/// One file, its frame number and time as `list_scans` reads them from the name (else 0 and none).
ScanFile scan_file(const std::filesystem::path& path);

/// The point files of a folder in order of number or name. A name of at most nine digits, or ten
/// beginning with 0, is a frame number; "SECONDS_FRACTION", "SECONDS.FRACTION" and 19 digits (ns)
/// are times. Throws `FormatError` where there is none, or a number comes twice.
std::vector<ScanFile> list_scans(const std::filesystem::path& folder);

/// What is known of all scans besides their files.
struct ScanPlacing {
  PoseList poses;             ///< By frame number where they have no times.
  std::string poses_name;     ///< For errors.
  std::vector<double> times;  ///< By frame number; empty = unknown.
  std::string times_name;
  bool points_in_world = false;
  FrameRange frames;
};

/// Joins files with poses and times into a source; fills `scans`, `scan_infos`, `skipped`, and adds
/// to `notes`. Throws `FormatError` where a selected scan has no pose or no time.
void place_scans(std::vector<ScanFile> files, const ScanPlacing& placing, Input& input);

}  // namespace underbrush::io
