// Scores as JSON, whose keys other programs rely on. This file is for sources that use JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "underbrush/metrics/baselines.hpp"
#include "underbrush/metrics/clouds.hpp"
#include "underbrush/metrics/range_image.hpp"
#include "underbrush/metrics/repeats.hpp"

namespace underbrush::pipeline {

/// Returns the first log's scores at the top and those of every log under `models` by name, each
/// with `per_class` and `per_range`; those of the baselines by name under `baselines`. Scores
/// without data are null; scores that were not asked for have no key.
nlohmann::ordered_json json_of_scores(const std::vector<std::string>& names,
                                      const std::vector<metrics::Score>& scores,
                                      const std::vector<metrics::Baseline>& baselines,
                                      const std::string& provenance);

/// Returns a comparison of clouds; scores without data are null.
nlohmann::ordered_json json_of_cloud_scores(const metrics::CloudScores& scores);

/// Returns the first comparison of clouds at the top and those of every log under `models` by name.
/// Scores without data are null.
nlohmann::ordered_json json_of_clouds(const std::vector<metrics::NamedCloudScores>& clouds,
                                      const std::string& provenance);

/// Returns the scores of range images, as learned simulators are scored.
nlohmann::ordered_json json_of_range_images(const metrics::ProtocolScores& scores);
/// Returns the comparison of scans that were recorded from one place.
nlohmann::ordered_json json_of_repeats(const metrics::Repeats& scores);

}  // namespace underbrush::pipeline
