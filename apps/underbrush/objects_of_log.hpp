/// Functions that the verbs on labelled logs and scenes share.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::app {

/// Throws `FormatError` unless the log has the columns that `segment` writes.
void require_objects(const std::string& file, BeamSource& log);

/// Fits the smooth ground of a labelled log as `fit` does, with nodes half of `spacing_m` (m)
/// apart. Errors call the log `file`.
elements::Model ground_of_log(const std::string& file, BeamSource& log, double spacing_m = 1);

/// Returns the objects by class, and what was left out, as JSON.
Json json_of(const primitives::MeasuredObjects& measured);
/// Returns the objects by class, and what was left out, as text.
std::string text_of(const primitives::MeasuredObjects& measured);

/// Returns a line for each count that is not zero.
std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts);

}  // namespace underbrush::app
