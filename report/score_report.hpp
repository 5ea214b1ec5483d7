/// \file
/// The page of a score.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "report/report.hpp"

namespace underbrush::report {

/// Writes `folder`/index.html with the scores `results` (`pipeline::json_of_scores`) of simulated
/// logs, each with its name, against the log `real`, and returns its path.
std::filesystem::path write_score_report(
    const std::filesystem::path& folder, const Json& results, const std::filesystem::path& real,
    const std::vector<std::pair<std::string, std::filesystem::path>>& simulated);

}  // namespace underbrush::report
