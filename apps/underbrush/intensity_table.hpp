/// \file
/// Scores of intensities as JSON and as text.
#pragma once
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/metrics/score.hpp"

namespace underbrush::app {

/// Returns the scores as JSON; a score without data is null.
Json json_of_intensity(const metrics::IntensityScore& score);
/// Returns the scores side by side, as `table_of_scores` has the others, or the line that says why
/// there are none.
std::string table_of_intensities(const std::vector<metrics::Score>& scores);

}  // namespace underbrush::app
