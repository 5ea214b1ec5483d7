// Scores as JSON, whose keys other programs rely on. This file is for sources that use JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "underbrush/pipeline/score_logs.hpp"

namespace underbrush::pipeline {

/// Returns the scores of one log with `per_class` and `per_range`, and those of the protocols that
/// were asked for under their names.
nlohmann::ordered_json json_of_log_score(const LogScore& score);

/// Returns the first log's scores at the top and those of every log under `models` by name; those
/// of the baselines by name under `baselines`. Scores without data are null; scores that were not
/// asked for have no key.
nlohmann::ordered_json json_of_scores(const Scores& scores, const std::string& provenance);

/// Returns a comparison of clouds; scores without data are null.
nlohmann::ordered_json json_of_cloud_scores(const metrics::CloudScores& scores);

/// Returns the first comparison of clouds at the top and those of every log under `models` by name.
/// Scores without data are null.
nlohmann::ordered_json json_of_clouds(const std::vector<metrics::NamedCloudScores>& clouds,
                                      const std::string& provenance);

}  // namespace underbrush::pipeline
