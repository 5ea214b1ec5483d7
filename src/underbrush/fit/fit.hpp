/// \file
/// This file declares `fit`, which turns a log into a model: it sorts points into tiles, separates
/// ground from the rest, makes elements of both, and estimates hit probabilities from the beams.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"

namespace underbrush {
/// Fits models to logs: the fitters, their parameters, and the files of a training.
namespace fit {

/// Fits a model to a log, whose rows may be echoes, with all that the model has: its classes
/// (`learn_classes`) and its light (`learn_light`) where the log has labels and intensities, its
/// keyframes and its grain. A log of up to 384 MiB (some six million beams) is read once
/// and stays in memory. A longer one is read for the channels, twice for the geometry (`likelihood`
/// reads it once more, and a long one in each step), for classes, for the light and for the grain;
/// memory grows with a tile and the model, not with the log. The result has the same bits for any
/// number of threads. `progress` may be empty. Throws `std::invalid_argument` for an unknown
/// fitter, for options out of range and for a log without returns.
FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress = {});

}  // namespace fit
}  // namespace underbrush
