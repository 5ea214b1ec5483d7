#include <functional>

#include "cli/progress.hpp"
#include "fit_options.hpp"
#include "fit_text.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/jobs/fit_stage.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace fit_verb {

struct Arguments {
  std::string log, output, splat, ground_mesh, update, echoes = "first";
  pipeline::UpdateLogOptions update_options;
  fit::FitOptions fit;
  jobs::FitStage stage;
};

/// Adds `--update` and its own options; `of_fit` have no place beside it.
void add_update_options(Verb& verb, Arguments& a, CLI::Option* update,
                        const std::vector<const CLI::Option*>& of_fit) {
  CLI::App& app = verb.app;
  for (const CLI::Option* option : of_fit) update->excludes(app.get_option(option->get_name()));
  update->excludes(app.get_option("--seed"));
  verb.begin_rare_group("fit --update");
  app.add_option("--growth", a.update_options.growth,
                 "Fit a tile anew when the number of its returns has grown by this share since its "
                 "last fit; 0 = always, so that the elements are those of one fit of all logs")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--logs", a.update_options.logs, "Folder that now holds the logs of the model")
      ->type_name("FOLDER")
      ->needs(update);
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (ray cloud PLY, as import writes it)")->required();
  verb.output("-o,--output", a.output, "The model's folder")->required()->type_name("MODEL");
  CLI::Option* update =
      app.add_option("--update", a.update,
                     "Add the log to this model, with its parameters, instead of starting anew")
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
                     "first = a beam ends at its first echo; all = each echo is treated as a beam, "
                     "and hit probabilities are shares of the light")
          ->check(CLI::IsMember({"first", "all"}))
          ->capture_default_str());
  add_update_options(verb, a, update, of_fit);
  verb.begin_rare_group("Stages of a fit, as a plan has them");
  CLI::Option* stage =
      verb.not_of_result(app.add_option("--stage", a.stage.name,
                                        "Run only this stage, and write its intermediate result")
                             ->type_name("begin|sum:FIRST:END|step|end")
                             ->configurable(false)
                             ->excludes(update));
  verb.not_of_result(app.add_option("--from", a.stage.from, "Results of the earlier stages")
                         ->type_name("PATH")
                         ->configurable(false)
                         ->needs(stage));
}

void export_model(const Arguments& a, const elements::Model& model) {
  if (!a.splat.empty()) elements::write_splat(a.splat, model);
  if (!a.ground_mesh.empty()) elements::write_mesh(a.ground_mesh, model.ground);
}

/// Writes what was fitted or updated, and reports it.
template <class Trained>
void finish(const Verb& verb, const Arguments& a, const Trained& trained,
            const pipeline::SkippedRows& skipped) {
  pipeline::write_trained(a.output, trained);
  export_model(a, trained.model);
  verb.report(json_of(trained, skipped), text_of(trained, skipped) +
                                             text_of_warnings(trained.report.warnings) +
                                             "  model       " + a.output + "\n");
}

void run_fit(const Verb& verb, const Arguments& a) {
  const auto log = pipeline::open_log(a.log, true);
  const pipeline::FittedModel fitted = pipeline::fit_model(
      {*log, a.log}, a.fit, std::bind_front(&Verb::provenance, &verb), shown<StageProgress>());
  finish(verb, a, fitted, log->skipped());
}

void run_update(const Verb& verb, const Arguments& a) {
  pipeline::TrainedModel known = pipeline::read_trained(a.update);
  const auto log = pipeline::open_log(a.log, known.model.all_echoes);
  const pipeline::UpdatedModel updated =
      pipeline::update_model(std::move(known), {*log, a.log}, a.update_options,
                             std::bind_front(&Verb::provenance, &verb), shown<StageProgress>());
  finish(verb, a, updated, log->skipped());
}

void run(const Verb& verb, Arguments& a) {
  a.fit.seed = verb.seed;
  if (a.echoes == "all") {
    fit::take_all_echoes(a.fit, verb.app.get_option("--keyframes")->count() > 0);
  }
  for (const std::string& file : {a.splat, a.ground_mesh}) {
    if (!file.empty()) io::check_output(file);
  }
  if (!a.stage.name.empty()) {
    const auto fitted =
        jobs::run_fit_stage(a.stage, a.log, a.fit, a.output,
                            std::bind_front(&Verb::provenance, &verb), shown<StageProgress>());
    return fitted ? finish(verb, a, *fitted, {}) : void();
  }
  elements::check_model_output(a.output);
  if (!a.update.empty()) return run_update(verb, a);
  require(a.update_options.growth == update::UpdateOptions().growth,
          "fit: --growth requires --update");
  run_fit(verb, a);
}

}  // namespace fit_verb
}  // namespace

void add_fit(Program& program) {
  using namespace fit_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Models", "fit", "Learn ground, ellipsoids and hit probabilities",
      "underbrush fit log.ply -o model/\n  underbrush fit log.ply --fitter surface -o mesh/\n"
      "  underbrush fit more.ply --update model/ -o grown/",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
