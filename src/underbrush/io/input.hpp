/// \file
/// Any supported log, opened: what it is, its scans or beams, and what is worth a remark.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::io {

/// Frames first, first + step, … below `end`.
struct FrameRange {
  uint32_t first = 0;
  uint32_t end = UINT32_MAX;
  uint32_t step = 1;
  bool has(uint32_t frame) const {
    return frame >= first && frame < end && (frame - first) % step == 0;
  }
};
/// From "A:B", "A:B:STEP", "A:" or ":B", half-open; `std::invalid_argument` otherwise.
FrameRange frames_from_text(const std::string& text);

/// How a log is to be read.
struct InputOptions {
  std::string format;            ///< One of `input_formats()`, empty = by the look of it.
  std::filesystem::path poses;   ///< TUM or KITTI; empty = the format's own.
  std::filesystem::path times;   ///< One number a line; empty = the format's own.
  std::filesystem::path labels;  ///< Of a single scan, as SemanticKITTI has them: extra `class`.
  FrameRange frames;             ///< Scans to take, by number.
  bool points_in_world = false;  ///< Points have been moved to the world frame by the poses.
};

/// An open log: either `beams` (every beam has its origin) or `scans` (points in the sensor's
/// frame).
struct Input {
  std::string format;
  std::unique_ptr<BeamSource> beams;
  std::unique_ptr<ScanSource> scans;
  std::vector<ScanInfo> scan_infos;  ///< Of the scans that `scans` will give.
  bool compensated = false;          ///< The scans' motion has been taken out already.
  std::vector<std::string> notes;    ///< What was assumed, one line each.
  std::string provenance;            ///< Of a log of ours.
  std::string classes;               ///< The label set of `scans`, as `LogInfo::classes`.
  /// Records left out so far, by reason.
  std::function<std::map<std::string, size_t>()> skipped;
};

/// Names of the formats: ray-cloud, csv, scan (one file), kitti (velodyne/NNNNNN.bin),
/// kitti-odometry, kitti-raw, folder (one file a scan).
std::vector<std::string> input_formats();

/// Opens a log; docs/reference/formats.md says what is looked for and where. Throws `FormatError` where the
/// path is no supported log, or a selected scan has no pose or time; `std::invalid_argument` for an
/// unknown format name.
Input open_input(const std::filesystem::path& path, const InputOptions& options = {});

}  // namespace underbrush::io
