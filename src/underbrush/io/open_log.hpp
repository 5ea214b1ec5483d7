/// \file
/// A log of any supported format that is open, and the choice of its frames.
#pragma once
#include <cstdint>
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

/// How times of points that are not absolute count: from the scan's time on; back from it, so that
/// the last point has 0; or so that the last point has the scan's time.
enum class TimesCount { kAfter, kBefore, kUntil };

/// An open log. Either `beams` is set (every beam has its own origin) or `scans` (points in the
/// sensor's frame).
struct Input {
  std::shared_ptr<const Unpacked> unpacked;  ///< The unpacked file, if the file was packed.
  std::string format;                        ///< Name of the format, one of `input_formats()`.
  bool is_log = false;                       ///< Whether `LogReader` reads the file itself.
  std::unique_ptr<BeamSource> beams;
  std::unique_ptr<ScanSource> scans;
  std::vector<ScanInfo> scan_infos;  ///< Number, time and pose of each scan that `scans` will
                                     ///< yield.
  std::optional<ScanClock> clock;    ///< Set where the scans have the times of a fitted clock.
  bool compensated = false;          ///< The scans are compensated for the sensor's motion already.
  std::vector<std::string> notes;    ///< Assumptions that the reader made, one line each.
  /// Returns the assumptions that were made while scans were read; empty where there are none.
  std::function<std::vector<std::string>()> read_notes;
  /// Returns what was found while scans were read that makes the points wrong; empty where nothing
  /// was.
  std::function<std::vector<std::string>()> read_warnings;
  std::string provenance;  ///< Provenance JSON; only Underbrush's own logs have one.
  std::string classes;     ///< Label set of the scans' labels, as in `LogInfo::classes`.
  /// Returns how many records were left out so far, by reason.
  std::function<std::map<std::string, size_t>()> skipped;
};

}  // namespace underbrush::io
