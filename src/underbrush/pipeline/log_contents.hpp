/// \file
/// The contents of a log for the verb `info`.
#pragma once
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::pipeline {

/// The numbers of records of a log that were left out when it was read, by reason.
using SkippedRows = std::map<std::string, size_t>;

/// The contents of a log, gathered in one pass.
struct LogContents {
  size_t beams = 0, hits = 0, recorded = 0, inferred = 0;
  size_t echoes = 0;  ///< Hits, and further echoes of their beams.
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  double first_s = INFINITY, last_s = -INFINITY;
  double low_intensity = INFINITY, high_intensity = -INFINITY;
  std::set<uint32_t> scans;
  std::set<uint16_t> rings;
  std::vector<size_t> ranges;      ///< Histogram in steps of 1 cm up to 1 km, then of 1 m to 21 km.
  std::vector<std::string> extra;  ///< Names of extra columns.

  /// Adds a chunk of the log.
  void add(const BeamLog& log);
  /// The range (m) that this share of the echoes does not exceed, at the middle of its bin.
  double range_percentile(double share) const;
};

/// Returns the log's sensor, or where it does not name one the sensors of the catalogue with as
/// many channels as it has rings.
std::vector<std::string> sensor_guess(const LogInfo& info, size_t rings);

}  // namespace underbrush::pipeline
