/// \file
/// This file declares the two ways to make a model from a log. The table of fitters names the
/// functions that call them.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_result.hpp"
#include "underbrush/surface/implicit.hpp"

namespace underbrush::fit {

/// Makes a ground mesh and the ellipsoids of the clustering `options.fitter`, or the ground mesh
/// alone where no clustering has that name. Hit probabilities are estimated and free space is
/// removed. Throws as `fit` does.
FitResult fit_ellipsoids(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress);

/// Makes one opaque mesh through all points, the zero surface of `distance`. Throws as `fit` does.
FitResult fit_surface(BeamSource& source, const FitOptions& options,
                      const surface::SignedDistance& distance, const FitProgress& progress);

}  // namespace underbrush::fit
