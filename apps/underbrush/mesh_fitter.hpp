/// The comparison simulator of [tallavajhula18] §V as a fitter: from a log to a scene of plant
/// meshes.
#pragma once
#include <filesystem>
#include <string>

#include "composing.hpp"
#include "steps.hpp"
#include "underbrush/primitives/measure.hpp"

namespace underbrush::app {

/// What came of it.
struct MeshFitStep {
  FitStep ground;  ///< Its `seconds` are of the whole.
  primitives::MeasuredObjects measured;
  primitives::Composition composition;
  std::vector<std::string> warnings;
};

/// The scene that these verbs give, and writes it:
///
///     fit LOG --fitter ground_mesh -o GROUND            with `options`
///     segment LOG -o LABELLED                           with its ground method, tile and min-range
///     annotate LABELLED --ground GROUND -o SITE
///     compose SITE PRIMITIVES -o SCENE
///
/// `primitives` is a set as `primitives_named` takes it. Throws `FormatError` for a log without
/// ground.
MeshFitStep fit_meshes(const Verb& verb, const std::filesystem::path& log,
                       const fit::FitOptions& options, const std::string& primitives,
                       const std::filesystem::path& scene);

}  // namespace underbrush::app
