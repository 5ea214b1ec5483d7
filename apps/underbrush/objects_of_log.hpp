/// What the verbs on labelled logs and scenes share.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// Throws `FormatError` unless the log has the columns that `segment` writes.
void require_objects(const std::string& file, BeamSource& log);

/// The ground of a labelled log, smooth, as `fit` makes it: nodes half of `spacing_m` apart. `file`
/// is what errors call the log.
elements::Model ground_of_log(const std::string& file, BeamSource& log, double spacing_m = 1);

/// The objects by class and what was left out, for people and for programs.
Json json_of(const primitives::MeasuredObjects& measured);
std::string text_of(const primitives::MeasuredObjects& measured);

/// A line for each count that is not zero.
std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts);

}  // namespace underbrush::app
