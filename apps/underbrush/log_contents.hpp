/// \file
/// What `info` tells of a log.
#pragma once
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::app {

/// The contents of a log, gathered in one pass.
struct LogContents {
  size_t beams = 0, hits = 0, recorded = 0, inferred = 0;
  size_t echoes = 0;  ///< Hits, and further echoes of their beams.
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  double first_s = INFINITY, last_s = -INFINITY;
  double low_intensity = INFINITY, high_intensity = -INFINITY;
  std::set<uint32_t> scans;
  std::set<uint16_t> rings;
  std::vector<size_t> ranges;      ///< Histogram in steps of 1 cm up to 1 km, and one bin beyond.
  std::vector<std::string> extra;  ///< Names of extra columns.

  /// Adds a chunk of the log.
  void add(const BeamLog& log);
};

/// Returns the contents as JSON; `input` is the log, read to its end.
Json json_of_log(const io::Input& input, const LogContents& contents);
/// Returns the contents as a table; `j` is what `json_of_log` returned.
std::string table_of_log(const std::string& file, const LogInfo& info, const LogContents& contents,
                         const Json& j);

}  // namespace underbrush::app
