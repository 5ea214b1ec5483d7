/// The scores of logs in files, with progress, and their table.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/metrics/baselines.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::app {

/// A simulated log to be scored, and the model that made it (or none).
struct Candidate {
  std::string name;
  std::filesystem::path log, model;  ///< `model` may be a scene or a world of regions.
};
/// Scores each candidate against the real log, a world of regions within `memory`.
std::vector<metrics::Score> score_logs(const std::filesystem::path& real,
                                       const std::vector<Candidate>& candidates, bool cloud,
                                       const std::string& memory = regions::kMemory);

/// Returns a function that opens a log; an empty one for an empty path.
metrics::OpenLog opener(const std::filesystem::path& log);
/// Scores the baselines on the beams of the real log; `train` may be empty.
std::vector<metrics::Baseline> score_baselines(const std::filesystem::path& real,
                                               const std::filesystem::path& train);

/// Returns the scores of candidates and of baselines side by side as text.
std::string table_of_scores(const std::vector<Candidate>& candidates,
                            const std::vector<metrics::Score>& scores,
                            const std::vector<metrics::Baseline>& baselines);

/// Adds the option for the folder of a report.
void add_report_option(Verb& verb, std::string& folder);

/// Returns the warnings, one on each line.
std::string text_of_warnings(const std::vector<std::string>& warnings);

}  // namespace underbrush::app
