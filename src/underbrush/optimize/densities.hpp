/// \file
/// Densities of a composed scene's classes, tuned on the beams of a log.
#pragma once
#include "underbrush/optimize/objective.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::optimize {

/// One parameter a class that the annotation has, in the order of `elements::Class` and under its
/// name: how many objects stand for each that is annotated, from a tenth to four.
std::vector<Parameter> density_parameters(const primitives::Annotation& annotation);

/// What a scene is composed of. All must outlive it.
struct SceneParts {
  const primitives::Annotation& annotation;
  const elements::Model& ground;
  const primitives::PrimitiveSet& primitives;
};

/// Composes with these densities and scores the beams. Throws as `primitives::compose`.
Outcome scene_outcome(const std::string& objective, const SceneParts& parts,
                      primitives::ComposeOptions options, std::span<const Parameter> densities,
                      std::span<const double> value, const BeamLog& beams);

}  // namespace underbrush::optimize
