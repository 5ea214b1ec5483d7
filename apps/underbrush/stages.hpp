/// The scores of logs in files, with progress, and their table.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/pipeline/score_logs.hpp"

namespace underbrush::app {

/// A simulated log to be scored, and the model that made it (or none).
struct Candidate {
  std::string name;
  std::filesystem::path log, model;  ///< `model` may be a scene or a world of regions.
};
/// Scores each candidate and the baselines against the real log, with progress. `train`, the log
/// that the models were fitted to, may be empty.
pipeline::Scores score_logs(const std::filesystem::path& real, const std::filesystem::path& train,
                            const std::vector<Candidate>& candidates,
                            const pipeline::ScoreOptions& options = {});

/// Returns the scores of simulated logs and baselines side by side as text.
std::string text_of_scores(const pipeline::Scores& scores);

/// Adds the option for the folder of a report.
void add_report_option(Verb& verb, std::string& folder);

/// Returns the warnings, one on each line.
std::string text_of_warnings(const std::vector<std::string>& warnings);

}  // namespace underbrush::app
