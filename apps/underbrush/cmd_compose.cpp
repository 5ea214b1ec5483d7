#include <fmt/format.h>

#include <chrono>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "scene_report.hpp"
#include "stages.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace compose_verb {

struct Arguments {
  std::string annotation, primitives, output, ground;
  pipeline::ComposeOptions options;
};

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  elements::check_scene_output(a.output);
  a.options.seed = verb.seed;
  pipeline::NamedSet named = pipeline::primitives_named(a.primitives, verb.seed);
  const std::vector<std::string> warnings = named.warnings;
  pipeline::ComposedScene composed = pipeline::compose_scene(
      a.annotation, std::move(named), nullptr, a.ground, a.options, shown<Progress>("compose"));
  primitives::Composition& c = composed.composition;
  c.info.provenance = provenance(verb, composed.inputs);
  elements::write_scene(a.output, c.scene, c.info);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  Json j = json_of(c);
  if (!a.options.leave_out.empty()) j["primitives_left_out"] = composed.primitives_left_out;
  j["warnings"] = warnings;
  j["seconds"] = seconds;
  std::string text = text_of(c);
  if (!a.options.leave_out.empty()) {
    text += fmt::format("  left out    {} primitives of plants of {}\n",
                        composed.primitives_left_out, fmt::join(a.options.leave_out, ", "));
  }
  text += text_of_warnings(warnings);
  text += fmt::format("  all         {:.2f} s\n  scene       {}\n", seconds, a.output);
  verb.report(j, text);
}

}  // namespace compose_verb
}  // namespace

void add_compose(Program& program) {
  using namespace compose_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "compose",
               "Compose a scene from primitives along an annotation, for simulate",
               "underbrush compose annotation.json primitives/ -o scene/\n"
               "  underbrush compose annotation.json primitives/ --nearest 5 --scale -o scene/\n"
               "  underbrush compose annotation.json mesh_primitives -o baseline/\n"
               "  underbrush simulate scene/ --like log.ply -o sim.ply",
               [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  app.add_option("ANNOTATION", a->annotation, "The annotation (JSON)")->required();
  app.add_option("PRIMITIVES", a->primitives,
                 "The folder of the set of primitives, or mesh_primitives: for the generated "
                 "plants that 'meshes generated' writes")
      ->required();
  verb->output("-o,--output", a->output, "The scene's folder")->required()->type_name("SCENE");
  app.add_option("--ground", a->ground, "Model whose ground replaces the annotation's")
      ->type_name("MODEL");
  add_options(*verb, pipeline::compose_options(), a->options);
}

}  // namespace underbrush::app
