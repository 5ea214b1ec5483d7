#include <fmt/format.h>

#include "steps.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

struct Arguments {
  std::string log, output, splat, ground_mesh;
  fit::FitOptions fit;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("LOG", a.log, "The log (ray cloud PLY, as import writes it)")->required();
  app.add_option("-o,--output", a.output, "The model's folder")->required()->type_name("MODEL");
  const auto option = [&](const char* name, auto& value, const char* text) {
    return app.add_option(name, value, text)->capture_default_str();
  };
  option("--fitter", a.fit.fitter, "How the model is made")
      ->check(CLI::IsMember(fit::fitter_names()));
  option("--start", a.fit.start, "likelihood: what it starts from, a fitter or a model's folder");
  option("--rounds", a.fit.likelihood.rounds, "likelihood: most steps that are tried");
  option("--held-out", a.fit.likelihood.held_out.one_in,
         "likelihood: one group of beams in so many judges the steps and is not learnt from");
  option("--dropout", a.fit.likelihood.dropout,
         "likelihood: how readily a lone miss is taken as a lost return, not as a way through");
  option("--tau", a.fit.tau, "Mahalanobis distance within which a beam meets an ellipsoid");
  option("--clusters-per-point", a.fit.volumetric.hierarchical.clusters_per_point,
         "hierarchical: number of ellipsoids per point");
  option("--min-points", a.fit.volumetric.hierarchical.min_points,
         "hierarchical: fewest points of an ellipsoid");
  option("--voxel-side", a.fit.volumetric.voxel.side_m,
         "voxel: side of a voxel, m (0.05 suits a standing scanner)");
  app.add_flag("--voxel-bounded", a.fit.volumetric.voxel.bounded,
               "voxel: a beam meets a Gaussian only within its own voxel");
  option("--top-down-stop", a.fit.volumetric.top_down.stop, "top_down: what leaves a cluster whole")
      ->check(CLI::IsMember({"points", "range_likelihood"}));
  option("--top-down-min-points", a.fit.volumetric.top_down.min_points,
         "top_down: fewest points of a half");
  option("--top-down-least-gain", a.fit.volumetric.top_down.least_gain,
         "top_down, range_likelihood: what a split must gain, nats");
  option("--top-down-largest-sigma", a.fit.volumetric.top_down.largest_sigma_m,
         "top_down, range_likelihood: larger clusters are split in any case, m");
  option("--bottom-up-cell", a.fit.volumetric.bottom_up.cell_m,
         "bottom_up: side of the first, small clusters, m");
  option("--bottom-up-density", a.fit.volumetric.bottom_up.least_density,
         "bottom_up: share of its parts' density that a merged ellipsoid must keep");
  option("--bottom-up-largest", a.fit.volumetric.bottom_up.largest_m,
         "bottom_up: greatest length of a merged ellipsoid, m");
  option("--covariance-prior", a.fit.volumetric.ellipsoid.prior_points,
         "Points' worth of the usual size mixed into each ellipsoid's covariance");
  option("--range-noise", a.fit.range_noise_m, "Sensor's range noise, m: floor of all extents");
  option("--min-range", a.fit.min_range_m,
         "Leave out returns nearer than this, m: the vehicle that carries the sensor");
  option("--ground-method", a.fit.segment.method, "Ground segmentation")
      ->check(CLI::IsMember({"lower_envelope", "spherical_variance", "none"}));
  option("--ground-spacing", a.fit.ground.spacing_m, "Ground surface: distance of nodes, m");
  option("--ground-smoothness", a.fit.ground.smoothness_m2,
         "Ground surface: weight of bending, m²");
  option("--credit", a.fit.credit.rule, "Which elements a beam says something of")
      ->check(CLI::IsMember(fit::credit_rules()));
  option("--credit-tau", a.fit.credit.tau_m,
         "credit mahalanobis: greatest distance of a beam from an ellipsoid; at most tau counts");
  option("--hit-estimator", a.fit.credit.estimator, "How an ellipsoid's counts become p")
      ->check(CLI::IsMember(fit::hit_estimators()));
  option("--hit-region", a.fit.credit.region_m,
         "empirical_bayes: side of the regions with a prior of their own, m");
  option("--ellipsoid-prior-hits", a.fit.credit.ellipsoid.a, "Prior hits of an ellipsoid");
  option("--ellipsoid-prior-misses", a.fit.credit.ellipsoid.b, "Prior misses of an ellipsoid");
  option("--triangle-prior-hits", a.fit.credit.triangle.a, "Prior hits of a triangle");
  option("--triangle-prior-misses", a.fit.credit.triangle.b, "Prior misses of a triangle");
  option("--free-space-below", a.fit.free_space_below,
         "Drop ellipsoids with hits / (hits + misses) below this: nothing stands there");
  option("--max-residual-for-hit", a.fit.credit.max_residual_for_hit_m,
         "A triangle explains a point nearer than this, m");
  option("--surface-cell", a.fit.surface.cell_m, "surface, rimls: cell of the marching cubes, m");
  option("--surface-kernel", a.fit.surface.kernel_m, "surface, rimls: radius of the kernel, m");
  option("--surface-least-kernel", a.fit.surface.least_kernel_m,
         "surface, rimls: radius down to which it is halved where points are dense, m");
  option("--surface-border", a.fit.surface.border,
         "surface, rimls: largest offset of the points' mean, in kernels; beyond is a hole");
  option("--surface-noise", a.fit.surface.noise_m,
         "surface, rimls: σ of the simulated range, m; 0 = as the points lie about the surface");
  app.add_flag("--surface-carve", a.fit.surface.carve,
               "surface, rimls: leave out what more beams passed than ended at");
  option("--tile", a.fit.tiles.tile_m, "Side of a tile, m");
  app.add_option("--export-splat", a.splat, "Also write the ellipsoids as a Gaussian splat PLY")
      ->type_name("FILE.ply");
  app.add_option("--export-ground", a.ground_mesh, "Also write the ground as a mesh")
      ->type_name("FILE.obj|.ply");
}

void run(const Verb& verb, Arguments& a) {
  a.fit.seed = verb.seed;
  for (const std::string& file : {a.splat, a.ground_mesh}) {
    if (!file.empty()) io::check_output(file);
  }
  const FitStep step = fit_log(verb, a.log, a.fit, a.output);
  const elements::Model& model = step.result.model;
  if (!a.splat.empty()) elements::write_splat(a.splat, model);
  if (!a.ground_mesh.empty()) elements::write_mesh(a.ground_mesh, model.ground);
  const fit::FitReport& r = step.result.report;
  Json j;
  j["fitter"] = model.fitter;
  j["beams"] = r.beams;
  j["hits"] = r.hits;
  j["misses"] = r.misses;
  j["ground_points"] = r.ground_points;
  j["other_points"] = r.other_points;
  j["near_points"] = r.near_points;
  j["carved_triangles"] = r.carved_triangles;
  j["thinned_points"] = r.thinned_points;
  j["unclustered_points"] = r.unclustered_points;
  j["free_space_ellipsoids"] = r.free_space_ellipsoids;
  j["max_range_m"] = model.max_range_m;
  j["tiles"] = r.tiles;
  j["ground_triangles"] = model.ground.size();
  j["surface_triangles"] = model.surface.size();
  j["ellipsoids"] = model.ellipsoids.size();
  j["ground_sigma_m"] = model.ground.range_sigma_m;
  j["skipped"] = step.skipped;
  j["warnings"] = r.warnings;
  if (!r.likelihood.steps.empty()) j["likelihood"] = json_of(r.likelihood);
  j["seconds"] = step.seconds;
  j["beams_per_s"] = double(r.beams) / step.seconds;
  std::string text = fmt::format(
      "{}: {} beams ({} hits, {} misses) in {:.1f} s, {} beams/s\n"
      "  ground      {} points, {} triangles, sigma {:.3f} m\n"
      "  other       {} points",
      model.fitter, r.beams, r.hits, r.misses, step.seconds, si(double(r.beams) / step.seconds),
      r.ground_points, model.ground.size(), model.ground.range_sigma_m, r.other_points);
  if (!model.ellipsoids.empty()) text += fmt::format(", {} ellipsoids", model.ellipsoids.size());
  if (model.surface.size()) text += fmt::format(", {} triangles", model.surface.size());
  if (r.unclustered_points) text += fmt::format(", {} in no cluster", r.unclustered_points);
  text += "\n";
  if (r.free_space_ellipsoids) {
    text += fmt::format("  dropped     {} ellipsoids in free space\n", r.free_space_ellipsoids);
  }
  if (r.carved_triangles) {
    text += fmt::format("  dropped     {} triangles that beams passed\n", r.carved_triangles);
  }
  if (r.near_points)
    text += fmt::format("  left out    {} points near the sensor\n", r.near_points);
  if (r.thinned_points)
    text += fmt::format("  left out    {} points of full tiles\n", r.thinned_points);
  for (const auto& [why, n] : step.skipped)
    text += fmt::format("  skipped     {} beams: {}\n", n, why);
  for (const fit::LikelihoodStep& s : r.likelihood.steps) {
    text += fmt::format("  {:<11} {} elements, -log f {:.4f} training, {:.4f} held out{}\n", s.name,
                        s.elements, s.training_nll, s.held_out_nll, s.accepted ? "" : ", undone");
  }
  for (const std::string& w : r.warnings) text += "  warning     " + w + "\n";
  text += "  model       " + a.output + "\n";
  verb.report(j, text);
}

}  // namespace

void add_fit(CLI::App& root) {
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      root, "fit", "Learn a model from a log: ground mesh, ellipsoids, hit probabilities",
      "underbrush fit log.ply -o model/\n  underbrush fit log.ply --fitter surface -o mesh/",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb->app, *a);
}

}  // namespace underbrush::app
