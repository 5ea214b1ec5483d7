#include "underbrush/fit/fitters.hpp"

#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/make_model.hpp"
#include "underbrush/fit/parameter_groups.hpp"

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

const Fitter kFitters[] = {
    {"likelihood",
     "The model of another fitter, refined by expectation and maximisation (the default)",
     {kLikelihood},
     {},
     nullptr,
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

}  // namespace underbrush::fit
