#include "underbrush/fit/part_options.hpp"

#include "underbrush/fit/fitters.hpp"

namespace underbrush::fit {

FitOptions start_options(FitOptions options) {
  if (!fitter_named(options.fitter).refines) return options;
  options.fitter = start_of(options).name;
  options.credit.triangle = options.likelihood.maximisation.triangle;
  // Refinement shares points between ellipsoids anyway, but only the mixture removes a footprint.
  if (!options.volumetric.mixture.footprint) options.volumetric.mixture.rounds = 0;
  return options;
}

likelihood::LikelihoodOptions likelihood_options(const FitOptions& options) {
  likelihood::LikelihoodOptions out = options.likelihood;
  out.range_noise_m = options.range_noise_m;
  // Along the normal of a surface seen at an angle of incidence of up to 60°, the noise of its
  // points is half of the range's or more.
  out.maximisation.floor_m = 0.5 * options.range_noise_m;
  out.held_out.seed = options.seed;
  return out;
}

keyframes::KeyframeOptions keyframe_options(const FitOptions& options) {
  keyframes::KeyframeOptions out = options.keyframes;
  out.min_range_m = options.min_range_m;
  out.held_out = likelihood_options(options).held_out;
  return out;
}

}  // namespace underbrush::fit
