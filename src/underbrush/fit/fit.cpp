#include "underbrush/fit/fit.hpp"

#include "underbrush/calibrate/channels.hpp"
#include "underbrush/calibrate/leaf_angles.hpp"
#include "underbrush/calibrate/light.hpp"
#include "underbrush/calibrate/observed_space.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/first_echoes.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/credit/element_classes.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/kept_beams.hpp"
#include "underbrush/fit/make_model.hpp"

namespace underbrush::fit {
namespace {

using namespace group;

/// The memory for the beams of a log that is read once, bytes.
constexpr size_t kKeptBytes = size_t(3) << 27;

ChannelOffsets offsets_of(BeamSource& source, const FitOptions& options) {
  if (options.ranges_as_given) return {};
  calibrate::ChannelOptions channels;
  channels.min_range_m = options.min_range_m;
  StillBeams still(source);
  return calibrate::learn_offsets(still, channels);
}

FitResult surface_by_imls(BeamSource& source, const FitOptions& options,
                          const FitProgress& progress) {
  return fit_surface(source, options, surface::imls, progress);
}

FitResult surface_by_rimls(BeamSource& source, const FitOptions& options,
                           const FitProgress& progress) {
  return fit_surface(source, options, surface::rimls, progress);
}

/// Makes the model that `likelihood` starts from, fitted to the beams that are not held out.
FitResult start_model(BeamSource& source, const FitOptions& options,
                      const credit::HeldOut& held_out, const FitProgress& progress) {
  if (elements::is_model(options.start)) return {elements::read_model(options.start), {}, {}};
  credit::TrainingSource training(source, held_out);
  return start_of(options).fit(training, start_options(options), progress);
}

FitResult fit_likelihood(BeamSource& source, const FitOptions& options,
                         const FitProgress& progress) {
  const likelihood::LikelihoodOptions refinement = likelihood_options(options);
  FitResult out = start_model(source, options, refinement.held_out, progress);
  StillBeams still(source);
  LogInfo info = source.info();
  if (!options.sensor.empty()) {
    info.sensor = options.sensor;
    info.sensor_file = options.sensor_file;
  }
  out.report.leaf_angles =
      calibrate::learn_leaf_angles(out.model, still, info, options.min_range_m);
  likelihood::Refined refined = likelihood::refine(out.model, still, refinement, progress);
  out.model = std::move(refined.model);
  out.model.fitter = options.fitter;
  out.report.likelihood = std::move(refined.report);
  const likelihood::LikelihoodReport& r = out.report.likelihood;
  out.report.beams = r.training_beams + r.held_out_beams;
  out.report.hits += r.held_out_hits;
  out.report.misses += r.held_out_beams - r.held_out_hits;
  return out;
}

void warn_of_footprint(const FitOptions& options, std::string_view clustering, FitReport& report) {
  const cluster::Clustering* found = cluster::clustering_named(clustering);
  if (!options.volumetric.mixture.footprint || (found && found->mixture)) return;
  report.warnings.push_back(
      "the sensor's footprint is taken out of the ellipsoids of hierarchical alone, not of those "
      "of " +
      std::string(clustering));
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
  check_options("fit", parameters(), options);
  require(options.unknown_cell_m == 0 || options.unknown_cell_m >= 0.25,
          "fit: unknown-cell must be 0 or at least 0.25 m");
  const Fitter& fitter = fitter_named(options.fitter);
  KeptBeams rows(source, kKeptBytes);
  FirstEchoes first(rows);
  BeamSource& beams = options.all_echoes ? static_cast<BeamSource&>(rows) : first;
  const bool given = !options.sensor.empty();
  const std::string sensor = given ? options.sensor : source.info().sensor;
  const ChannelOffsets channels = sensor.empty() ? ChannelOffsets() : offsets_of(beams, options);
  CorrectedBeams corrected(beams, channels);
  FitResult out = fitter.fit(corrected, options, progress);
  out.model.range_noise_m = options.range_noise_m;
  out.model.sensor = sensor;
  out.model.sensor_file = given ? options.sensor_file : source.info().sensor_file;
  out.model.channels = channels;
  out.model.all_echoes = options.all_echoes;
  StillBeams still(corrected);
  credit::learn_classes(out.model, still);
  calibrate::learn_light(out.model, still);
  if (fitter.refines && !options.all_echoes) {
    keyframes::learn_keyframes(out.model, still, keyframe_options(options));
  }
  if (fitter.refines) {
    calibrate::learn_observed_space(out.model, still,
                                    {options.unknown_cell_m, options.min_range_m});
  }
  if (options.learn_grain) {
    out.report.grain = calibrate::learn_grain(out.model, first, options.seed);
    out.report.sway = calibrate::learn_sway(out.model, first, options.seed);
    out.report.echo_grain = calibrate::learn_grain_of_echoes(out.model, rows, options.seed);
  }
  warn_of_footprint(options, fitter.refines ? start_of(options).name : fitter.name, out.report);
  return out;
}

}  // namespace underbrush::fit
