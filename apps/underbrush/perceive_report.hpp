/// \file
/// What `perceive` tells of a log, as JSON.
#pragma once
#include "cli/verb.hpp"
#include "underbrush/pipeline/perceive_log.hpp"

namespace underbrush::app {

/// Returns counts, the scores against the truth if there is one, and the area of each kind of cells
/// if there is a grid.
Json json_of(const pipeline::Perceived& perceived);

}  // namespace underbrush::app
