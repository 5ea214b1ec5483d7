#include <fmt/ranges.h>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace compose_verb {

struct Arguments {
  std::string annotation, primitives, output, ground;
  pipeline::ComposeOptions options;
};

std::string text_of(const pipeline::ComposedScene& composed,
                    const pipeline::ComposeOptions& options, const Json& j) {
  const primitives::Composition& c = composed.composition;
  std::string text = fmt::format(
      "{} objects: {} instances of {} primitives ({} elements), boxes {:.2f} m apart on average\n",
      c.objects, c.placed, c.scene.models.size() - 1, j["elements"].get<size_t>(),
      c.mean_box_distance_m);
  if (c.objects == 0) text += line("warning", "there are no objects: the scene is its ground");
  for (const auto& [label, n] : c.borrowed) {
    text += line("warning", "{} of class {}: no primitives, placed with those of another size", n,
                 label);
  }
  for (const auto& [label, n] : c.left_out) {
    text += line("warning", "{} of class {} left out: no primitives of its kind", n, label);
  }
  if (c.off_ground) {
    text += line("warning", "{} left out: they stand off the ground mesh", c.off_ground);
  }
  if (!options.leave_out.empty()) {
    text += line("left out", "{} primitives of plants of {}", composed.primitives_left_out,
                 fmt::join(options.leave_out, ", "));
  }
  return text + text_of_warnings(composed.warnings) +
         line("composing", "{:.2f} s", composed.seconds);
}

void run(const Verb& verb, Arguments& a) {
  a.options.seed = verb.seed;
  pipeline::NamedSet set = pipeline::primitives_named(a.primitives, verb.seed);
  pipeline::ComposedScene composed;
  if (regions::is_site(a.annotation)) {
    require(a.ground.empty(), "compose: the parts of a site have grounds of their own");
    composed = pipeline::compose_parts(
        a.output, a.annotation, std::move(set), a.options,
        [&](const auto& inputs) { return provenance(verb, inputs); }, shown<Progress>("compose"));
  } else {
    elements::check_scene_output(a.output);
    composed = pipeline::compose_scene(a.annotation, std::move(set), nullptr, a.ground, a.options,
                                       shown<Progress>("compose"));
    primitives::Composition& c = composed.composition;
    c.info.provenance = provenance(verb, composed.inputs);
    elements::write_scene(a.output, c.scene, c.info);
  }
  const Json j = json_of(composed, a.options);
  verb.report(j, text_of(composed, a.options, j) + line("scene", "{}", a.output));
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
  app.add_option("ANNOTATION", a->annotation,
                 "The annotation (JSON), or the folder of a site in parts")
      ->required();
  app.add_option("PRIMITIVES", a->primitives,
                 "The folder of a set of primitives, or the word mesh_primitives for the plants of "
                 "'meshes generated'")
      ->required();
  verb->output("-o,--output", a->output,
               "The folder of the scene; for a site in parts, the folder of a world of regions")
      ->required()
      ->type_name("SCENE");
  app.add_option("--ground", a->ground, "Model whose ground replaces the annotation's")
      ->type_name("MODEL");
  add_options(*verb, pipeline::compose_options(), a->options);
}

}  // namespace underbrush::app
