/// \file
/// Opens a log of any supported format.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/scan_clock.hpp"

namespace underbrush::io {

/// Selects the frames first, first + step, … below `end`.
struct FrameRange {
  uint32_t first = 0;
  uint32_t end = UINT32_MAX;
  uint32_t step = 1;
  bool has(uint32_t frame) const {
    return frame >= first && frame < end && (frame - first) % step == 0;
  }
};
/// Parses "A:B", "A:B:STEP", "A:" or ":B" (half-open). Throws `std::invalid_argument` for any other
/// text.
FrameRange frames_from_text(const std::string& text);

/// The reason for which points are skipped that are nowhere near the sensor.
inline constexpr const char* kFarFromSensor = "farther than 1000 km from the sensor";
/// What is asked where the points seem to be those of a world.
inline constexpr const char* kWorldCoordinates =
    "are its coordinates those of the world? Then --poses must say where the sensor stood, and "
    "--points-in-world";

/// Options of `open_input`.
struct InputOptions {
  std::string format;            ///< One of `input_formats()`; empty: it is detected.
  std::filesystem::path poses;   ///< File of poses, TUM or KITTI; empty: the format's own.
  std::filesystem::path times;   ///< File with one time (s) for each line; empty: the format's own.
  std::filesystem::path labels;  ///< SemanticKITTI labels of a single scan; they become the extra
                                 ///< column `class`.
  FrameRange frames;             ///< Scans to read, by number.
  bool points_in_world = false;  ///< The points are in the world frame already; by default they are
                                 ///< in the sensor's.
  bool fit_clock = false;        ///< Put scans whose times were rounded back on a steady clock.
  std::vector<std::string> columns;  ///< Names of the columns of files that have none.
  double unit_m = 1;                 ///< Unit of the coordinates, m.
  double scan_period_s = 0;          ///< Time between scans, s, where their times do not tell it.
};

/// An open log. Either `beams` is set (every beam has its own origin) or `scans` (points in the
/// sensor's frame).
struct Input {
  std::shared_ptr<const Unpacked> unpacked;  ///< The file itself, if it was packed.
  std::string format;                        ///< Name of the format, one of `input_formats()`.
  bool is_log = false;                       ///< `LogReader` reads the file itself.
  std::unique_ptr<BeamSource> beams;
  std::unique_ptr<ScanSource> scans;
  std::vector<ScanInfo> scan_infos;  ///< Number, time and pose of each scan that `scans` will
                                     ///< yield.
  std::optional<ScanClock> clock;    ///< Set where the scans have the times of a fitted clock.
  bool compensated = false;          ///< The scans are compensated for the sensor's motion already.
  std::vector<std::string> notes;    ///< Assumptions that the reader made, one line each.
  /// Returns the assumptions that were made while scans were read; empty where there are none.
  std::function<std::vector<std::string>()> read_notes;
  std::string provenance;  ///< Provenance JSON; only Underbrush's own logs have one.
  std::string classes;     ///< Label set of the scans' labels, as in `LogInfo::classes`.
  /// Returns how many records were left out so far, by reason.
  std::function<std::map<std::string, size_t>()> skipped;
};

/// Returns the names of the formats: ray-cloud, compact, csv, scan (one file), kitti
/// (velodyne/NNNNNN.bin), kitti-odometry, kitti-raw, and folder (one file for each scan).
std::vector<std::string> input_formats();

/// Opens a log, which may be packed by gzip if it is one file. docs/reference/formats.md says which
/// files are looked for, and where. Throws `FormatError` where the path is no supported log or a
/// selected scan has no pose or time, and `std::invalid_argument` for an unknown format name.
Input open_input(const std::filesystem::path& path, const InputOptions& options = {});

}  // namespace underbrush::io
