#include "fit_options.hpp"

#include "composing.hpp"
#include "underbrush/elements/scene_file.hpp"

namespace underbrush::app {
namespace {

std::vector<std::string> fitter_names() {
  std::vector<std::string> names = fit::fitter_names();
  names.emplace_back(kMeshPrimitives);
  return names;
}

/// Empty, or what is wrong with where `likelihood` is to start.
std::string wrong_start(const std::string& start) {
  if (start != kMeshPrimitives && !elements::is_scene(start)) return {};
  return "likelihood refines a model, but " + start + " is a scene of opaque plants";
}

}  // namespace

fit::Footprint footprint_of(const sensor::Sensor& sensor) {
  return [beam = sensor.beam](double range_m) { return beam.sigma_m(range_m); };
}

void add_fit_options(CLI::App& app, fit::FitOptions& fit) {
  const auto option = [&](const char* name, auto& value, const char* text) {
    return app.add_option(name, value, text)->capture_default_str();
  };
  option("--fitter", fit.fitter, "How the model is made")->check(CLI::IsMember(fitter_names()));
  option("--start", fit.start, "likelihood: what it starts from, a fitter or a model's folder")
      ->check(wrong_start);
  option("--rounds", fit.likelihood.rounds,
         "likelihood: most rearrangements at first, and most steps after them");
  option("--held-out", fit.likelihood.held_out.one_in,
         "likelihood: one group of beams in so many judges the steps and is not learnt from");
  option("--dropout", fit.likelihood.dropout,
         "likelihood: how readily a lone miss is taken as a lost return, not as a way through");
  option(
      "--sharpness", fit.likelihood.sharpness,
      "likelihood: how much more decided than the likeliest model: above 1 for smaller errors of "
      "a draw, at the cost of likelihood");
  option("--merge-cost", fit.likelihood.rearrangement.largest_cost,
         "likelihood: most that merging two ellipsoids may cost their points, nats; 0: merge where "
         "it costs nothing");
  option("--tau", fit.tau, "Mahalanobis distance within which a beam meets an ellipsoid");
  option("--clusters-per-point", fit.volumetric.hierarchical.clusters_per_point,
         "hierarchical: number of ellipsoids per point");
  option("--min-points", fit.volumetric.hierarchical.min_points,
         "hierarchical: fewest points of an ellipsoid");
  option("--mixture-rounds", fit.volumetric.mixture.rounds,
         "hierarchical: rounds in which ellipsoids share the points where clusters part them; "
         "likelihood does so itself");
  app.add_option_function<std::string>(
         "--sensor",
         [&fit](const std::string& name) {
           fit.volumetric.mixture.footprint = footprint_of(sensor::load(name));
         },
         "hierarchical: the sensor of the log (of the catalogue, or a YAML file): ellipsoids are "
         "narrowed by the footprint of its beam")
      ->type_name("SENSOR");
  option("--voxel-side", fit.volumetric.voxel.side_m,
         "voxel: side of a voxel, m (0.05 suits a standing scanner)");
  app.add_flag("--voxel-bounded", fit.volumetric.voxel.bounded,
               "voxel: a beam meets a Gaussian only within its own voxel");
  option("--top-down-stop", fit.volumetric.top_down.stop, "top_down: what leaves a cluster whole")
      ->check(CLI::IsMember({"points", "range_likelihood"}));
  option("--top-down-min-points", fit.volumetric.top_down.min_points,
         "top_down: fewest points of a half");
  option("--top-down-least-gain", fit.volumetric.top_down.least_gain,
         "top_down, range_likelihood: what a split must gain, nats");
  option("--top-down-largest-sigma", fit.volumetric.top_down.largest_sigma_m,
         "top_down, range_likelihood: larger clusters are split in any case, m");
  option("--bottom-up-cell", fit.volumetric.bottom_up.cell_m,
         "bottom_up: side of the first, small clusters, m");
  option("--bottom-up-density", fit.volumetric.bottom_up.least_density,
         "bottom_up: share of its parts' density that a merged ellipsoid must keep");
  option("--bottom-up-largest", fit.volumetric.bottom_up.largest_m,
         "bottom_up: greatest length of a merged ellipsoid, m");
  option("--covariance-prior", fit.volumetric.ellipsoid.prior_points,
         "Points' worth of the usual size mixed into each ellipsoid's covariance");
  option("--range-noise", fit.range_noise_m, "Sensor's range noise, m: floor of all extents");
  option("--min-range", fit.min_range_m,
         "Leave out returns nearer than this, m: the vehicle that carries the sensor");
  option("--ground-method", fit.segment.method, "Ground segmentation")
      ->check(CLI::IsMember({"lower_envelope", "spherical_variance", "none"}));
  option("--ground-spacing", fit.ground.spacing_m, "Ground surface: distance of nodes, m");
  option("--ground-smoothness", fit.ground.smoothness_m2, "Ground surface: weight of bending, m²");
  option("--ground-error", fit.triangulate.max_error_m,
         "Ground surface: largest error of its triangles, m");
  option("--credit", fit.credit.rule, "Which elements a beam says something of")
      ->check(CLI::IsMember(fit::credit_rules()));
  option("--credit-tau", fit.credit.tau_m,
         "credit mahalanobis: greatest distance of a beam from an ellipsoid; at most tau counts");
  option("--hit-estimator", fit.credit.estimator, "How an ellipsoid's counts become p")
      ->check(CLI::IsMember(fit::hit_estimators()));
  option("--hit-region", fit.credit.region_m,
         "empirical_bayes: side of the regions with a prior of their own, m");
  option("--ellipsoid-prior-hits", fit.credit.ellipsoid.a, "Prior hits of an ellipsoid");
  option("--ellipsoid-prior-misses", fit.credit.ellipsoid.b, "Prior misses of an ellipsoid");
  option("--triangle-prior-hits", fit.credit.triangle.a, "Prior hits of a triangle");
  option("--triangle-prior-misses", fit.credit.triangle.b, "Prior misses of a triangle");
  option("--free-space-below", fit.free_space_below,
         "Drop ellipsoids with hits / (hits + misses) below this: nothing stands there");
  option("--max-residual-for-hit", fit.credit.max_residual_for_hit_m,
         "A triangle explains a point nearer than this, m");
  option("--surface-cell", fit.surface.cell_m, "surface, rimls: cell of the marching cubes, m");
  option("--surface-kernel", fit.surface.kernel_m, "surface, rimls: radius of the kernel, m");
  option("--surface-least-kernel", fit.surface.least_kernel_m,
         "surface, rimls: radius down to which it is halved where points are dense, m");
  option("--surface-border", fit.surface.border,
         "surface, rimls: largest offset of the points' mean, in kernels; beyond is a hole");
  option("--surface-noise", fit.surface.noise_m,
         "surface, rimls: σ of the simulated range, m; 0 = as the points lie about the surface");
  app.add_flag("--surface-carve", fit.surface.carve,
               "surface, rimls: leave out what more beams passed than ended at");
  option("--tile", fit.tiles.tile_m, "Side of a tile, m");
}

}  // namespace underbrush::app
