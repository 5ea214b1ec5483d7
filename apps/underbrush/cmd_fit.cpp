#include <fmt/format.h>

#include "cli/progress.hpp"
#include "fit_json.hpp"
#include "fit_options.hpp"
#include "light_report.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "update_log.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace fit_verb {

struct Arguments {
  std::string log, output, splat, ground_mesh, update, logs, echoes = "first";
  update::UpdateOptions how;
  fit::FitOptions fit;
};

/// Adds `--update` and its own options; `of_fit` have no place beside it.
void add_update_options(Verb& verb, Arguments& a, CLI::Option* update,
                        const std::vector<const CLI::Option*>& of_fit) {
  CLI::App& app = verb.app;
  for (const CLI::Option* option : of_fit) update->excludes(app.get_option(option->get_name()));
  update->excludes(app.get_option("--seed"));
  verb.begin_rare_group("fit --update");
  app.add_option("--growth", a.how.growth,
                 "Fit a touched tile anew once its returns have grown by this share since it was "
                 "fitted; 0: at once, which gives the elements of one fit of all logs")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--logs", a.logs, "Where the logs that the model was fitted to are now")
      ->type_name("FOLDER")
      ->needs(update);
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (ray cloud PLY, as import writes it)")->required();
  verb.output("-o,--output", a.output, "The model's folder")->required()->type_name("MODEL");
  CLI::Option* update =
      app.add_option("--update", a.update,
                     "Add the log to this model, whose parameters hold, instead of starting again")
          ->type_name("MODEL");
  std::vector<const CLI::Option*> of_fit = add_fit_options(verb, a.fit);
  verb.begin_rare_group("Other outputs");
  verb.output("--export-splat", a.splat, "Write the ellipsoids as a splat, too")
      ->type_name("FILE.ply");
  verb.output("--export-ground", a.ground_mesh, "Write the ground as a mesh, too")
      ->type_name("FILE.obj|.ply");
  verb.begin_rare_group("Echoes");
  of_fit.push_back(
      app.add_option("--echoes", a.echoes,
                     "Take the first echo of a beam for its end, or all echoes for beams of their "
                     "own; hit probabilities are then shares of the light")
          ->check(CLI::IsMember({"first", "all"}))
          ->capture_default_str());
  add_update_options(verb, a, update, of_fit);
}

std::string text_of_fit(const std::string& fitter, const FitStep& step) {
  const elements::Model& model = step.result.model;
  const fit::FitReport& r = step.result.report;
  std::string text = fmt::format(
      "{}: {} beams ({} hits, {} misses) in {:.1f} s, {} beams/s\n"
      "  ground      {} points, {} triangles, sigma {:.3f} m\n"
      "  other       {} points",
      fitter, r.beams, r.hits, r.misses, step.seconds, si(double(r.beams) / step.seconds),
      r.ground_points, model.ground.size(), model.ground.range_sigma_m, r.other_points);
  if (!model.ellipsoids.empty()) text += fmt::format(", {} ellipsoids", model.ellipsoids.size());
  if (model.surface.size()) text += fmt::format(", {} triangles", model.surface.size());
  if (r.unclustered_points) text += fmt::format(", {} in no cluster", r.unclustered_points);
  text += "\n" + text_of_channels(model.channels);
  if (r.free_space_ellipsoids) {
    text += fmt::format("  dropped     {} ellipsoids in free space\n", r.free_space_ellipsoids);
  }
  if (r.carved_triangles) {
    text += fmt::format("  dropped     {} triangles that beams passed\n", r.carved_triangles);
  }
  if (r.mover_points) text += fmt::format("  left out    {} returns of movers\n", r.mover_points);
  if (r.near_points)
    text += fmt::format("  left out    {} points near the sensor\n", r.near_points);
  if (r.thinned_points)
    text += fmt::format("  left out    {} points of full tiles\n", r.thinned_points);
  if (r.grain.learnt()) {
    text += fmt::format(
        "  grain       {:.3f} m of ellipsoids, {:.3f} m of meshes: {:.1f} cm rough along rings, "
        "the log {:.1f} cm\n",
        model.grain.ellipsoid_m, model.grain.mesh_m, 100 * r.grain.simulated_m,
        100 * r.grain.real_m);
  }
  for (size_t k = 0; k < model.grain.classes.size(); ++k) {
    const elements::ClassGrain& c = model.grain.classes[k];
    text += fmt::format("              {:.3f} m of {}{}\n", c.side_m, model.class_name(c.label),
                        r.grain.classes[k] ? "" : ", the usual one: too few beams met it");
  }
  text += text_of_light(model) + text_of_keyframes(model);
  if (r.echo_grain.learnt) {
    text += fmt::format("  echoes      {:.3f} of a beam that returns, the log {:.3f}\n",
                        r.echo_grain.simulated, r.echo_grain.real);
  }
  for (const auto& [why, n] : step.skipped)
    text += fmt::format("  skipped     {} beams: {}\n", n, why);
  for (const likelihood::LikelihoodStep& s : r.likelihood.steps) {
    const std::string training =
        s.training_nll ? fmt::format(" {:.4f} training,", *s.training_nll) : "";
    text += fmt::format("  {:<11} {} elements, -log f{} {:.4f} held out{}\n", s.name, s.elements,
                        training, s.held_out_nll, s.accepted ? "" : ", undone");
  }
  return text;
}

void export_model(const Arguments& a, const elements::Model& model) {
  if (!a.splat.empty()) elements::write_splat(a.splat, model);
  if (!a.ground_mesh.empty()) elements::write_mesh(a.ground_mesh, model.ground);
}

void run_update(const Verb& verb, const Arguments& a) {
  const UpdateStep step = update_log(verb, {a.update, a.log, a.logs, a.how}, a.output);
  export_model(a, step.result.model);
  verb.report(json_of(step), text_of(step) + text_of_warnings(step.result.report.warnings) +
                                 "  model       " + a.output + "\n");
}

void run(const Verb& verb, Arguments& a) {
  a.fit.seed = verb.seed;
  a.fit.all_echoes = a.echoes == "all";
  if (a.fit.all_echoes) {
    const bool wanted = verb.app.get_option("--keyframes")->count() > 0;
    require(!wanted || a.fit.keyframes.spacing_m == 0,
            "fit: --keyframes remember beams, not the single echoes of --echoes all");
    a.fit.keyframes.spacing_m = 0;
  }
  for (const std::string& file : {a.splat, a.ground_mesh}) {
    if (!file.empty()) io::check_output(file);
  }
  if (!a.update.empty()) return run_update(verb, a);
  require(a.how.growth == update::UpdateOptions().growth, "fit: --growth requires --update");
  const FitStep step = fit_log(verb, a.log, a.fit, a.output);
  const elements::Model& model = step.result.model;
  export_model(a, model);
  const std::vector<std::string>& warnings = step.result.report.warnings;
  verb.report(json_of(step), text_of_fit(model.fitter, step) + text_of_warnings(warnings) +
                                 "  model       " + a.output + "\n");
}

}  // namespace fit_verb
}  // namespace

void add_fit(Program& program) {
  using namespace fit_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Models", "fit",
      "Learn a model from a log: ground mesh, ellipsoids, hit probabilities",
      "underbrush fit log.ply -o model/\n  underbrush fit log.ply --fitter surface -o mesh/\n"
      "  underbrush fit more.ply --update model/ -o grown/",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
