/// Scores as JSON: the keys other programs rely on.
#pragma once
#include "underbrush/metrics/score.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// The first log's scores at the top, those of every log under `models` by name; each with
/// `per_class` and `per_range`. Scores without data are null, those not asked for have no key.
Json json_of_scores(const std::vector<std::string>& names,
                    const std::vector<metrics::Score>& scores, const std::string& provenance);

}  // namespace underbrush::app
