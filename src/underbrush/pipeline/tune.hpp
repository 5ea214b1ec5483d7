/// \file
/// The verb `optimize`: parameters of a fit, or densities of a scene's classes, that are judged by
/// the answers that a user would get.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "underbrush/fit/fit.hpp"
#include "underbrush/optimize/objective.hpp"
#include "underbrush/optimize/search.hpp"
#include "underbrush/optimize/slice.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::pipeline {

/// What `optimize::search` minimises: the parameters, where it starts, and the function that judges
/// their values.
struct TuningProblem {
  std::vector<optimize::Parameter> parameters;
  std::vector<double> start;
  std::function<optimize::Outcome(std::span<const double>)> objective;
};

/// Simulates the beams with default options and scores the answers. Likelihood and CRPS are
/// computed only for the objective `nll`, which needs them.
optimize::Outcome outcome_of(const std::string& objective, const TracedWorld& world,
                             const BeamLog& beams, uint64_t seed);

/// Parameters of a fit, by `names` or the usual ones if there is none: a model is fitted to one
/// part of the slice and scored on the other. Throws as `optimize::chosen_fit_parameters` does.
TuningProblem tuned_fit(const std::string& objective, std::shared_ptr<const optimize::Slice> slice,
                        const fit::FitOptions& options, std::span<const std::string> names);

/// The parts of a composed scene.
struct SceneParts {
  primitives::Annotation annotation;
  elements::Model ground;
  primitives::PrimitiveSet primitives;
};

/// Densities of a scene's classes, by `names` or all if there is none: a scene is composed and
/// scored on the beams. Throws `DataError` for an annotation without objects.
TuningProblem tuned_scene(const std::string& objective, std::shared_ptr<const SceneParts> parts,
                          BeamLog beams, uint64_t seed, std::span<const std::string> names);

}  // namespace underbrush::pipeline
