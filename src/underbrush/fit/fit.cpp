#include "underbrush/fit/fit.hpp"

#include "underbrush/core/still_beams.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/fit_parts.hpp"
#include "underbrush/fit/make_model.hpp"

namespace underbrush::fit {
namespace {

using namespace group;

FitResult surface_by_imls(BeamSource& source, const FitOptions& options,
                          const FitProgress& progress) {
  return fit_surface(source, options, surface::imls, progress);
}

FitResult surface_by_rimls(BeamSource& source, const FitOptions& options,
                           const FitProgress& progress) {
  return fit_surface(source, options, surface::rimls, progress);
}

FitResult fit_likelihood(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress) {
  FitResult out = start_of_refinement(source, options, progress);
  StillBeams still(source);
  take_refined(likelihood::refine(out.model, still, likelihood_options(options), progress), options,
               out);
  return out;
}

const Fitter kFitters[] = {
    {"likelihood",
     "The model of another fitter, refined by expectation and maximisation (the default)",
     {kLikelihood},
     {},
     fit_likelihood,
     /*refines=*/true},
    {"hierarchical",
     "Permeable ellipsoids of hierarchical clusters on a ground mesh",
     {kHierarchical, kEllipsoids, kHitProbability},
     {kGround},
     fit_ellipsoids},
    {"voxel",
     "Permeable ellipsoids, one an occupied voxel, on a ground mesh",
     {kVoxel, kEllipsoids, kHitProbability},
     {kGround},
     fit_ellipsoids},
    {"top_down",
     "Permeable ellipsoids of recursive 2-means on a ground mesh",
     {kTopDown, kEllipsoids, kHitProbability},
     {kGround},
     fit_ellipsoids},
    {"bottom_up",
     "Permeable ellipsoids merged from small ones on a ground mesh",
     {kBottomUp, kEllipsoids, kHitProbability},
     {kGround},
     fit_ellipsoids},
    {"ground_mesh", "The ground mesh alone", {kGround, kHitProbability}, {}, fit_ellipsoids},
    {"surface",
     "One opaque mesh over all points: the everyday baseline",
     {kSurface},
     {kHitProbability},
     surface_by_imls},
    {"rimls",
     "One opaque mesh over all points, by a robust implicit surface",
     {kSurface},
     {kHitProbability},
     surface_by_rimls},
};

}  // namespace

std::span<const Fitter> fitters() { return kFitters; }

const Fitter& fitter_named(std::string_view name) {
  for (const Fitter& f : kFitters) {
    if (f.name == name) return f;
  }
  throw std::invalid_argument("fit: no fitter '" + std::string(name) + "'");
}

const Fitter& start_of(const FitOptions& options) {
  if (elements::is_model(options.start)) return fitter_named(options.fitter);
  if (elements::is_scene(options.start)) {
    throw std::invalid_argument("fit: --start needs a fitter or a model, and " + options.start +
                                " is a scene");
  }
  const Fitter& start = fitter_named(options.start);
  if (start.refines) {
    throw std::invalid_argument("fit: " + options.fitter + " needs another fitter to start with");
  }
  return start;
}

std::vector<std::string> fitter_names() {
  std::vector<std::string> names;
  for (const Fitter& f : kFitters) names.emplace_back(f.name);
  return names;
}

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

FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress) {
  const Fitter& fitter = checked_fitter(options);
  FitBeams beams(source, options);
  const ChannelOffsets channels = offsets_of(beams, options);
  CorrectedBeams corrected(beams.ends, channels);
  FitResult out = fitter.fit(corrected, options, progress);
  out.model.channels = channels;
  learn_the_rest(beams, options, fitter, out);
  return out;
}

}  // namespace underbrush::fit
