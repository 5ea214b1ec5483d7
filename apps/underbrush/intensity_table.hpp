/// \file
/// Scores of intensities as text.
#pragma once
#include <string>
#include <vector>

#include "underbrush/metrics/score.hpp"

namespace underbrush::app {

/// Returns the scores side by side, as `table_of_scores` has the others, or the line that says why
/// there are none.
std::string table_of_intensities(const std::vector<metrics::Score>& scores);

}  // namespace underbrush::app
