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

/// Compares each candidate and each baseline with the real log. Adds the results to their entries
/// under `models` and `baselines` in `results`, and returns them side by side as text; empty if
/// nothing was asked for. `train` may be empty.
std::string score_protocols(const Protocols& asked, const std::filesystem::path& real,
                            const std::filesystem::path& train,
                            const std::vector<Candidate>& candidates, Json& results);

}  // namespace underbrush::app
