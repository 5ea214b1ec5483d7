/// \file
/// The verb `optimize`: parameters of a fit, or densities of a scene's classes, that are scored by
/// the answers that a user would get.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/fit/fit_options.hpp"
#include "underbrush/optimize/objective.hpp"
#include "underbrush/optimize/options.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::pipeline {

/// The problem that a search minimises: the parameters, their start, and the objective function of
/// their values.
struct TuningProblem {
  std::vector<optimize::Parameter> parameters;
  std::vector<double> start;
  std::function<optimize::Outcome(std::span<const double>)> objective;
  optimize::SliceFacts slice;                 ///< The sizes of the slice of the log.
  std::vector<std::filesystem::path> inputs;  ///< The files that were read besides the log.
  std::vector<std::string> warnings;
};

/// Simulates the beams with default options and scores the answers. Likelihood and CRPS are
/// computed only for the objective `nll`, which needs them.
optimize::Outcome outcome_of(const std::string& objective, const TracedWorld& world,
                             const BeamLog& beams, uint64_t seed);

/// Parameters of a fit, those of `options.tune` or the usual ones: a model is fitted to one part of
/// the slice and scored on the other. Throws as `optimize::take_slice` and
/// `optimize::chosen_fit_parameters` do; names are checked before the log is read.
TuningProblem tuned_fit(BeamSource& log, const optimize::TuneOptions& options,
                        const fit::FitOptions& fit);

/// The parts of a scene whose class densities are tuned.
struct SceneParts {
  primitives::Annotation annotation;
  elements::Model ground;
  primitives::PrimitiveSet primitives;
  std::vector<std::filesystem::path> inputs;  ///< The files that the parts were read from.
  std::vector<std::string> warnings;
};

/// Reads an annotation with its ground, and the primitives, as `primitives::read_annotation` and
/// `primitives_named` take them. Throws `FormatError`, also for an annotation without objects.
SceneParts read_scene_parts(const std::filesystem::path& annotation, const std::string& primitives,
                            bool allow_outside, uint64_t seed);

/// Densities of a scene's classes, those of `options.tune` or all: a scene is composed and scored
/// on the beams of the slice.
TuningProblem tuned_scene(BeamSource& log, const optimize::TuneOptions& options, SceneParts parts);

/// Searches for the values with the lowest objective; `past` and `after` are those of
/// `optimize::search`.
std::vector<optimize::Evaluation> tune(
    const TuningProblem& problem, const optimize::TuneOptions& options,
    const std::vector<optimize::Evaluation>& past = {},
    const std::function<void(std::span<const optimize::Evaluation>)>& after = {});

}  // namespace underbrush::pipeline
