/// \file
/// The ground of a labelled log.
#pragma once
#include <string>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::primitives {

/// Fits the smooth ground of a labelled log as `fit` does, with nodes half of `spacing_m` (m)
/// apart. Throws `FormatError`, which calls the log `file`, where none of its points is ground.
elements::Model ground_of_log(const std::string& file, BeamSource& log, double spacing_m = 1,
                              const MeasureProgress& progress = {});

}  // namespace underbrush::primitives
