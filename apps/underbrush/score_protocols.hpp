/// Comparisons of logs that `score` makes on request.
#pragma once
#include <string>
#include <vector>

#include "stages.hpp"

namespace underbrush::app {

/// What `score` compares besides its own scores.
struct Protocols {
  bool kitti360 = false;  ///< Range images, as learned simulators are scored.
  bool repeats = false;   ///< Scans that repeat their directions.
};

/// Compares each candidate with the real log, adds the results to its entry under `models` in
/// `results`, and returns them side by side as text; empty if nothing was asked for.
std::string score_protocols(const Protocols& asked, const std::filesystem::path& real,
                            const std::vector<Candidate>& candidates, Json& results);

}  // namespace underbrush::app
