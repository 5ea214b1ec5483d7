/// \file
/// What `import` tells of what it read.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::app {

/// Counts of the log's records by what became of them.
struct ImportCounts {
  size_t scans = 0, beams = 0;
  size_t later_returns = 0;  ///< Rows of `beams` that are no first return.
  sensor::BeamCounts beam;
  std::map<std::string, size_t> skipped;
};

/// Says what became of all records where no beam is left, and what to do where the points seem to
/// be those of a world.
std::string nothing_usable(const ImportCounts& counts, bool points_in_world);

/// Returns a warning where more than 3 % of the recorded misses are lost: hit probabilities are
/// learnt from misses.
std::vector<std::string> warnings_of(const ImportCounts& counts);

Json json_of(const io::Input& input, const ImportCounts& counts,
             const std::vector<std::string>& warnings);

/// Returns the counts as a table; `output` is the log that was written.
std::string table_of(const io::Input& input, const ImportCounts& counts, const std::string& output);

}  // namespace underbrush::app
