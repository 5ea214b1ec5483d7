/// \file
/// The options of the parts of a fit.
#pragma once
#include "underbrush/fit/fit_options.hpp"

namespace underbrush::fit {

/// The options of the fitter that makes the first model of a refinement; for a fitter that does not
/// refine, its own.
FitOptions start_options(FitOptions options);

/// σ of the smallest element (m): a larger one would blur surfaces, and the range noise is added
/// when a beam is answered.
double least_extent_m(const FitOptions& options);

/// The options that `fit` passes to `refine`: `options.likelihood` with the range noise, the floor
/// and the seed filled in.
likelihood::LikelihoodOptions likelihood_options(const FitOptions& options);

/// The options that `fit` passes to `learn_keyframes`.
keyframes::KeyframeOptions keyframe_options(const FitOptions& options);

}  // namespace underbrush::fit
