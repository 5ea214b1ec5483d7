/// \file
/// This file declares `fit`, which turns a log into a model: it sorts points into tiles, tells
/// ground from the rest, makes elements of both, and estimates hit probabilities from the beams.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/calibrate/grain.hpp"
#include "underbrush/calibrate/leaf_angles.hpp"
#include "underbrush/calibrate/sway.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/fit_options.hpp"
#include "underbrush/fit/fit_record.hpp"

namespace underbrush {
/// Fits models to logs: the fitters, their parameters, and the files of a training.
namespace fit {

/// Counts and warnings of a fit.
struct FitReport {
  size_t beams = 0, hits = 0, misses = 0;
  size_t ground_points = 0, other_points = 0;
  size_t mover_points = 0;           ///< Left out because they have the flag `kMover`.
  size_t near_points = 0;            ///< Left out because they are nearer than `min_range_m`.
  size_t far_points = 0;             ///< Beyond the maximum range of the log.
  size_t carved_triangles = 0;       ///< Dropped because of `surface.carve`.
  size_t thinned_points = 0;         ///< Left out because their tile was full.
  size_t unclustered_points = 0;     ///< In no cluster of at least `min_points`.
  size_t free_space_ellipsoids = 0;  ///< Dropped as free space.
  size_t tiles = 0;
  likelihood::LikelihoodReport likelihood;  ///< Has steps only if the fitter is `likelihood`.
  calibrate::GrainReport grain;
  calibrate::LeafAngleReport leaf_angles;
  calibrate::SwayReport sway;
  calibrate::EchoGrainReport echo_grain;  ///< Learnt only from several echoes a beam.
  std::vector<std::string> warnings;
};

/// A model, the report of its fit, and what `update` needs to know of it.
struct FitResult {
  elements::Model model;
  FitReport report;
  FitRecord record;
};

/// Receives the progress of a fit: the name of the stage, the work done and the total.
using FitProgress = std::function<void(std::string_view, size_t, size_t)>;

/// The names of the fitters, in the order of the table.
std::vector<std::string> fitter_names();

/// Fits a model to a log, whose rows may be echoes, with all that the model has: its classes
/// (`learn_classes`) and its light (`learn_light`) where the log has labels and intensities, its
/// keyframes and its grain. A log of up to 384 MiB (some six million beams) is read once
/// and stays in memory. A longer one is read for the channels, twice for the geometry (`likelihood`
/// reads it once more, and a long one in each step), for classes, for the light and for the grain;
/// memory grows with a tile and the model, not with the log. The result has the same bits for any
/// number of threads. `progress` may be empty. Throws `std::invalid_argument` for an unknown
/// fitter, for options out of range and for a log without returns.
FitResult fit(BeamSource& source, const FitOptions& options, const FitProgress& progress = {});

/// The options of the fitter that makes the first model of a refinement; for a fitter that does not
/// refine, its own.
FitOptions start_options(FitOptions options);

/// The options that `fit` passes to `refine`: `options.likelihood` with the range noise, the floor
/// and the seed filled in.
likelihood::LikelihoodOptions likelihood_options(const FitOptions& options);

/// The options that `fit` passes to `learn_keyframes`.
keyframes::KeyframeOptions keyframe_options(const FitOptions& options);

}  // namespace fit
}  // namespace underbrush
