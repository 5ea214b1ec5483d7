/// \file
/// Scores of intensities as text.
#pragma once
#include <string>
#include <vector>

#include "underbrush/metrics/score.hpp"

namespace underbrush::report {

/// Returns the scores side by side, as the program prints the others, or the line with the reason
/// for which there are none.
std::string table_of_intensities(const std::vector<metrics::Score>& scores);

}  // namespace underbrush::report
