#include <functional>

#include "cli/option_table.hpp"
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
  std::vector<std::string> logs;
  std::string output, splat, ground_mesh, update;
  update::FitLogOptions of_log;
  fit::FitOptions fit;
  jobs::FitStage stage;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.logs, "The log, or logs of one place (.ply or .ublog)")->required();
  verb.output("-o,--output", a.output, "The model's folder")->required()->type_name("MODEL");
  CLI::Option* update =
      app.add_option("--update", a.update,
                     "Add the log to this model, with its parameters, instead of starting anew")
          ->type_name("MODEL");
  const std::vector<const CLI::Option*> of_fit = add_fit_options(verb, a.fit);
  verb.begin_rare_group("Other outputs");
  verb.output("--export-splat", a.splat, "Write the ellipsoids as a splat, too")
      ->type_name("FILE.ply");
  verb.output("--export-ground", a.ground_mesh, "Write the ground as a mesh, too")
      ->type_name("FILE.obj|.ply");
  app::add_options(verb, update::fit_log_options(), a.of_log);
  for (const CLI::Option* option : of_fit) update->excludes(app.get_option(option->get_name()));
  for (const char* name : {"--echoes", "--seed"}) update->excludes(app.get_option(name));
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
  io::LogSequence logs({a.logs.begin(), a.logs.end()});
  const pipeline::FittedModel fitted =
      pipeline::fit_model({logs, logs.files()}, a.fit, std::bind_front(&Verb::provenance, &verb),
                          shown<StageProgress>());
  finish(verb, a, fitted, logs.skipped());
}

void run_update(const Verb& verb, const Arguments& a) {
  require(a.logs.size() == 1, "fit: --update adds one log");
  pipeline::TrainedModel known = pipeline::read_trained(a.update);
  const auto log = pipeline::open_log(a.logs[0], known.model.all_echoes);
  const pipeline::UpdatedModel updated =
      pipeline::update_model(std::move(known), {*log, {a.logs[0]}}, a.of_log,
                             std::bind_front(&Verb::provenance, &verb), shown<StageProgress>());
  finish(verb, a, updated, log->skipped());
}

void run(const Verb& verb, Arguments& a) {
  a.fit.seed = verb.seed;
  a.of_log.check(!a.update.empty());
  if (a.of_log.echoes == "all") {
    fit::take_all_echoes(a.fit, verb.app.get_option("--keyframes")->count() > 0);
  }
  for (const std::string& file : {a.splat, a.ground_mesh}) {
    if (!file.empty()) io::check_output(file);
  }
  if (!a.stage.name.empty()) {
    io::LogSequence logs({a.logs.begin(), a.logs.end()});
    const auto fitted =
        jobs::run_fit_stage(a.stage, logs, a.fit, a.output,
                            std::bind_front(&Verb::provenance, &verb), shown<StageProgress>());
    return fitted ? finish(verb, a, *fitted, {}) : void();
  }
  elements::check_model_output(a.output);
  if (!a.update.empty()) return run_update(verb, a);
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
      "  underbrush fit monday.ublog tuesday.ublog -o model/\n"
      "  underbrush fit more.ply --update model/ -o grown/",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
