/// \file
/// The two kinds of model that a log is made into; the table of fitters names their callers.
#pragma once
#include "underbrush/fit/fit.hpp"

namespace underbrush::fit {

/// A ground mesh and the ellipsoids of the clustering `options.fitter` (none where no clustering
/// has that name), with hit probabilities, without free space. Throws as `fit`.
FitResult fit_ellipsoids(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress);

/// One opaque mesh through all points, the zero surface of `distance`. Throws as `fit`.
FitResult fit_surface(BeamSource& source, const FitOptions& options, const SignedDistance& distance,
                      const FitProgress& progress);

}  // namespace underbrush::fit
