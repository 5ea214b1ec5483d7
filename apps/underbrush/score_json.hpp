/// Scores as JSON, whose keys other programs rely on.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/metrics/baselines.hpp"

namespace underbrush::app {

/// Returns the first log's scores at the top and those of every log under `models` by name, each
/// with `per_class` and `per_range`; those of the baselines by name under `baselines`. Scores
/// without data are null; scores that were not asked for have no key.
Json json_of_scores(const std::vector<std::string>& names,
                    const std::vector<metrics::Score>& scores,
                    const std::vector<metrics::Baseline>& baselines, const std::string& provenance);

/// Writes `folder`/index.html with the scores `results` (`json_of_scores`) of simulated logs, each
/// with its name, against the log `real`, and returns its path.
std::filesystem::path write_score_report(
    const std::filesystem::path& folder, const Json& results, const std::filesystem::path& real,
    const std::vector<std::pair<std::string, std::filesystem::path>>& simulated);

}  // namespace underbrush::app
