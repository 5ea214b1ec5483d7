/// What the verbs on labelled logs and scenes share.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::app {

/// Throws `FormatError` unless the log has the columns that `segment` writes.
void require_objects(const std::string& file, BeamSource& log);

/// A line for each count that is not zero.
std::string left_out(const std::vector<std::pair<std::string, size_t>>& counts);

}  // namespace underbrush::app
