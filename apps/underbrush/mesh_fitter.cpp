#include "mesh_fitter.hpp"

#include <chrono>

#include "labelled_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

primitives::MeasuredObjects objects_of(const fs::path& path, const elements::Model& ground,
                                       const fit::FitOptions& options) {
  io::LogReader log(path);
  primitives::SegmentLogOptions segment;
  segment.ground = options.segment;
  segment.tile_m = options.tiles.tile_m;
  segment.min_range_m = options.min_range_m;
  LabelsOfHits found;
  {
    StageProgress progress;
    found = found_of(primitives::segment_log(log, segment, {}, std::ref(progress)));
  }
  LabelledSource labelled(log, found, LabelledCounts("", false));
  const primitives::GroundSurface surface(ground);
  Progress progress("annotate");
  return primitives::measure_objects(labelled, surface, {}, std::ref(progress));
}

}  // namespace

MeshFitStep fit_meshes(const Verb& verb, const fs::path& log, const fit::FitOptions& options,
                       const std::string& primitives, const fs::path& scene) {
  const auto start = std::chrono::steady_clock::now();
  elements::check_scene_output(scene);
  const NamedSet named = primitives_named(primitives, verb.seed);
  fit::FitOptions of_ground = options;
  of_ground.fitter = "ground_mesh";
  MeshFitStep step;
  step.ground = fit_log(log, of_ground);
  const elements::Model& ground = step.ground.result.model;
  if (ground.ground.size() == 0) {
    throw FormatError(log.string(), "",
                      "none of its points is ground: plants have nowhere to stand");
  }
  step.measured = objects_of(log, ground, options);
  primitives::ComposeOptions compose;
  compose.seed = verb.seed;
  primitives::Annotation annotation;
  for (const auto& o : step.measured.objects) {
    annotation.objects.push_back(primitives::as_written(o));
  }
  step.composition = composed(annotation, ground, named.set, compose);
  std::vector<fs::path> inputs{log};
  inputs.insert(inputs.end(), named.inputs.begin(), named.inputs.end());
  step.composition.info.provenance = provenance(verb, inputs);
  elements::write_scene(scene, step.composition.scene, step.composition.info);
  step.warnings = step.ground.result.report.warnings;
  step.warnings.insert(step.warnings.end(), named.warnings.begin(), named.warnings.end());
  step.ground.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return step;
}

}  // namespace underbrush::app
