#include "underbrush/fit/part_options.hpp"

#include "underbrush/fit/effort.hpp"
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

double least_extent_m(const FitOptions& options) {
  return cluster::EllipsoidOptions{.floor_m = options.range_noise_m}.least_m();
}

likelihood::LikelihoodOptions likelihood_options(const FitOptions& options) {
  likelihood::LikelihoodOptions out = options.likelihood;
  out.range_noise_m = options.range_noise_m;
  out.maximisation.floor_m = least_extent_m(options);
  out.held_out.seed = options.seed;
  out.shares = effort_named(options.effort).steps;
  return out;
}

keyframes::KeyframeOptions keyframe_options(const FitOptions& options) {
  keyframes::KeyframeOptions out = options.keyframes;
  out.min_range_m = options.min_range_m;
  out.held_out = likelihood_options(options).held_out;
  return out;
}

}  // namespace underbrush::fit
