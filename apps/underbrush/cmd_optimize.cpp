#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "cli/option_table.hpp"
#include "fit_options.hpp"
#include "report/report.hpp"
#include "report/tuning.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_file.hpp"
#include "underbrush/optimize/checkpoint.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/kept_search.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace optimize_verb {
namespace fs = std::filesystem;

struct Arguments {
  std::string log, output, annotation, primitives, report, checkpoint;
  optimize::TuneOptions options;
  bool resume = false, allow_outside = false;
  fit::FitOptions fit;
  std::vector<const CLI::Option*> fit_options;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The training log")->required();
  verb.output("-o,--output", a.output, "The configuration file for 'fit --config'")
      ->required()
      ->type_name("PARAMS.yaml");
  app::add_options(verb, optimize::tune_options(), a.options);
  verb.begin_rare_group("Search");
  app.add_flag("--allow-outside", a.allow_outside, pipeline::kAllowOutsideHelp);
  verb.begin_group("Options");
  verb.output("--checkpoint", a.checkpoint,
              "File written after each evaluation (default: PARAMS.yaml.checkpoint)")
      ->type_name("FILE");
  verb.not_of_result(
      app.add_flag("--resume", a.resume, "Continue from the checkpoint if there is one"));
  verb.begin_group("Densities of a scene");
  auto* site = app.add_option("--annotation", a.annotation,
                              "Tune the class densities of a scene composed along this annotation "
                              "instead; the result is for 'compose --config'")
                   ->type_name("SITE.json");
  auto* set = app.add_option("--primitives", a.primitives,
                             "The primitives from which the scene is composed, as for compose")
                  ->type_name("PRIMITIVES");
  site->needs(set);
  set->needs(site);
  verb.begin_group("Options");
  add_report_option(verb, a.report);
  a.fit_options = add_fit_options(verb, a.fit, kAllRare);
}

/// A search: what it minimises, and what is said of it.
struct Search {
  pipeline::TuningProblem problem;
  report::Tuning tuning;
};

Json given_options(const Arguments& a, const std::vector<optimize::Parameter>& tuned) {
  Json out = Json::object();
  for (const CLI::Option* option : a.fit_options) {
    const std::string name = option->get_lnames().front();
    const bool is_tuned =
        std::any_of(tuned.begin(), tuned.end(), [&](const auto& p) { return p.name == name; });
    if (option->count() == 0 || is_tuned) continue;
    const std::string value = option->results().back();
    out[name] = value;
  }
  return out;
}

Search search_of(const Arguments& a, BeamSource& log) {
  const bool is_scene = !a.annotation.empty();
  Search s;
  if (is_scene) {
    s.problem = pipeline::tuned_scene(
        log, a.options,
        pipeline::read_scene_parts(a.annotation, a.primitives, a.allow_outside, a.options.seed));
  } else {
    s.problem = pipeline::tuned_fit(log, a.options, a.fit);
  }
  s.tuning.parameters = s.problem.parameters;
  s.tuning.what = report::sentence_on(s.problem.slice, a.options.cut(), is_scene);
  s.tuning.densities = is_scene;
  if (!is_scene) s.tuning.fixed = given_options(a, s.tuning.parameters);
  return s;
}

/// The file of a search, which is known by the provenance of its result.
pipeline::SearchFile file_of(const Arguments& a, const report::Tuning& tuning) {
  const Json origin = io::json_of_text(tuning.provenance);
  pipeline::SearchFile out{a.checkpoint, a.resume, origin["program"], {}, tuning.fixed.dump()};
  for (const auto& [file, hash] : origin["inputs"].items()) {
    if (!file.ends_with(".yaml")) out.inputs.push_back(hash);
  }
  return out;
}

void run(const Verb& verb, Arguments& a) {
  const auto begin = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  a.fit.seed = a.options.seed = verb.seed;
  a.options.cut();  // This throws for values out of range before anything is written.
  if (a.checkpoint.empty()) a.checkpoint = a.output + ".checkpoint";
  // A damaged checkpoint is bad input of --resume, before it is an output to protect.
  if (a.resume && fs::exists(a.checkpoint)) optimize::read_checkpoint(a.checkpoint);
  verb.check_all_outputs();  // Now the checkpoint has a name.
  io::check_output(a.output);
  io::check_output(a.checkpoint);
  if (!a.report.empty()) report::check_report_output(a.report);
  io::LogReader reader(a.log);
  Search s = search_of(a, reader);
  report::Tuning& t = s.tuning;
  t.log = a.log;
  t.objective = a.options.objective;
  std::vector<fs::path> inputs{a.log};
  inputs.insert(inputs.end(), s.problem.inputs.begin(), s.problem.inputs.end());
  t.provenance = provenance(verb, inputs);
  const pipeline::SearchFile file = file_of(a, t);
  size_t resumed = 0;
  try {
    pipeline::KeptSearch kept = pipeline::tune_and_keep(
        s.problem, a.options, file, [&](std::span<const optimize::Evaluation> so_far) {
          std::cerr << fmt::format("[{:.1f} s] {}\n", seconds(),
                                   report::line_of(t, so_far, a.options.search.budget))
                    << std::flush;
        });
    t.evaluations = std::move(kept.evaluations);
    resumed = kept.resumed;
  } catch (const DataError& e) {
    throw FormatError(a.log, "", e.what());
  }
  report::write_config(a.output, t);
  pipeline::end_search(file);
  Json j = report::json_of(t);
  j["warnings"] = s.problem.warnings;
  j["resumed_from"] = resumed;
  j["skipped"] = reader.skipped();
  j["seconds"] = seconds();
  std::string text = report::text_of(t) + text_of_warnings(s.problem.warnings) + "  written     " +
                     a.output + "\n";
  if (!a.report.empty())
    text += "  report      " + report::write_tuning_report(a.report, t).string() + "\n";
  verb.report(j, text);
}

}  // namespace optimize_verb
}  // namespace

void add_optimize(Program& program) {
  using namespace optimize_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Models", "optimize", "Tune the parameters of a fit on a slice of a log",
               "underbrush optimize train.ply -o params.yaml --report tuning/\n"
               "  underbrush optimize train.ply -o params.yaml --resume\n"
               "  underbrush fit train.ply --config params.yaml -o model/",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
