/// \file
/// This file tunes the densities of a composed scene's classes on the beams of a log.
#pragma once
#include "underbrush/optimize/objective.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::optimize {

/// Makes one parameter for each class of the annotation, in the order of `elements::Class` and
/// under the class's name. Its value is the number of objects for each annotated one, from 0.1 to
/// 4.
std::vector<Parameter> density_parameters(const primitives::Annotation& annotation);

/// The parts of a composed scene. All of them must outlive it.
struct SceneParts {
  const primitives::Annotation& annotation;
  const elements::Model& ground;
  const primitives::PrimitiveSet& primitives;
};

/// Composes a scene with these densities and scores its answers to the beams. Throws as
/// `primitives::compose` does.
Outcome scene_outcome(const std::string& objective, const SceneParts& parts,
                      primitives::ComposeOptions options, std::span<const Parameter> densities,
                      std::span<const double> value, const BeamLog& beams);

}  // namespace underbrush::optimize
