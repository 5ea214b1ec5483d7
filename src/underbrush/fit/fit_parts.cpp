#include "underbrush/fit/fit_parts.hpp"

#include <algorithm>

#include "underbrush/calibrate/channels.hpp"
#include "underbrush/calibrate/leaf_angles.hpp"
#include "underbrush/calibrate/light.hpp"
#include "underbrush/calibrate/observed_space.hpp"
#include "underbrush/calibrate/repeats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/credit/element_classes.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/effort.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/fit/part_options.hpp"
#include "underbrush/keyframes/keyframes.hpp"

namespace underbrush::fit {
namespace {

/// The memory for the beams of a log that is read once, bytes.
constexpr size_t kKeptBytes = size_t(3) << 27;

/// Counts the hits and misses of a log, of which only a share was fitted to.
void count_beams(BeamSource& log, FitReport& report) {
  report.hits = report.misses = 0;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) ++(chunk.is_hit(i) ? report.hits : report.misses);
  }
}

/// Makes the model that `likelihood` starts from, fitted to the beams that are not held out.
FitResult start_model(BeamSource& source, const FitOptions& options,
                      const credit::HeldOut& held_out, const FitProgress& progress) {
  if (elements::is_model(options.start)) return {elements::read_model(options.start), {}, {}, {}};
  credit::TrainingSource all(source, held_out);
  credit::TrainingSource training(source, held_out, effort_named(options.effort).start);
  FitOptions start = start_options(options);
  start.volumetric.spacing = cluster::beam_spacing(all);
  FitResult out = start_of(options).fit(training, start, progress);
  if (!effort_named(options.effort).start.is_all()) count_beams(all, out.report);
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

}  // namespace

FitResult start_of_refinement(BeamSource& source, const FitOptions& options,
                              const FitProgress& progress) {
  FitResult out = start_model(source, options, likelihood_options(options).held_out, progress);
  StillBeams still(source);
  LogInfo info = source.info();
  if (!options.sensor.empty()) {
    info.sensor = options.sensor;
    info.sensor_file = options.sensor_file;
  }
  out.report.leaf_angles =
      calibrate::learn_leaf_angles(out.model, still, info, options.min_range_m);
  return out;
}

void take_refined(likelihood::Refined refined, const FitOptions& options, FitResult& out) {
  out.model = std::move(refined.model);
  out.model.fitter = options.fitter;
  out.report.likelihood = std::move(refined.report);
  const likelihood::LikelihoodReport& r = out.report.likelihood;
  out.report.beams = r.training_beams + r.held_out_beams;
  out.report.hits += r.held_out_hits;
  out.report.misses += r.held_out_beams - r.held_out_hits;
}

FitBeams::FitBeams(BeamSource& source, const FitOptions& options)
    : echoes(source, kKeptBytes),
      first_echoes(echoes),
      fitted(options.all_echoes ? static_cast<BeamSource&>(echoes) : first_echoes),
      sensor(options.sensor.empty() ? source.info().sensor : options.sensor) {}

ChannelOffsets offsets_of(FitBeams& beams, const FitOptions& options) {
  if (options.ranges_as_given || beams.sensor.empty()) return {};
  calibrate::ChannelOptions channels;
  channels.min_range_m = options.min_range_m;
  StillBeams still(beams.fitted);
  return calibrate::learn_offsets(still, channels);
}

FitOptions with_measured_noise(FitOptions options, FitBeams& beams) {
  StillBeams still(beams.first_echoes);
  const auto measured = calibrate::range_noise_of(calibrate::repeats_of(still, options.seed));
  if (measured) options.range_noise_m = std::min(options.range_noise_m, *measured);
  return options;
}

const Fitter& checked_fitter(const FitOptions& options) {
  check_options("fit", parameters(), options);
  require(options.unknown_cell_m == 0 || options.unknown_cell_m >= 0.25,
          "fit: unknown-cell must be 0 or at least 0.25 m");
  return fitter_named(options.fitter);
}

void learn_all_but_geometry(FitBeams& beams, const FitOptions& options, const Fitter& fitter,
                            FitResult& out) {
  CorrectedBeams corrected(beams.fitted, out.model.channels);
  out.model.range_noise_m = options.range_noise_m;
  out.model.sensor = beams.sensor;
  out.model.sensor_file =
      options.sensor.empty() ? corrected.info().sensor_file : options.sensor_file;
  out.model.all_echoes = options.all_echoes;
  StillBeams still(corrected);
  credit::learn_classes(out.model, still);
  calibrate::learn_light(out.model, still, effort_named(options.effort).samples_of_light);
  if (fitter.refines && !options.all_echoes) {
    keyframes::learn_keyframes(out.model, still, keyframe_options(options));
  }
  if (fitter.refines) {
    calibrate::learn_observed_space(out.model, still,
                                    {options.unknown_cell_m, options.min_range_m});
  }
  if (options.learn_grain) {
    out.report.grain = calibrate::learn_grain(out.model, beams.first_echoes, options.seed);
    out.report.sway = calibrate::learn_sway(out.model, beams.first_echoes, options.seed);
    out.report.echo_grain = calibrate::learn_grain_of_echoes(out.model, beams.echoes, options.seed);
  }
  warn_of_footprint(options, fitter.refines ? start_of(options).name : fitter.name, out.report);
}

}  // namespace underbrush::fit
