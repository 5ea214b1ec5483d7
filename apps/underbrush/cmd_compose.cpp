#include <fmt/format.h>

#include <chrono>

#include "composition.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/primitives/leave_out.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace compose_verb {

struct Arguments {
  std::string annotation, primitives, output, ground;
  std::vector<std::string> density, leave_out;
  bool strict = false, allow_outside = false;
  primitives::ComposeOptions compose;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("ANNOTATION", a.annotation, "The annotation (JSON)")->required();
  app.add_option("PRIMITIVES", a.primitives,
                 "The folder of the set of primitives, or mesh_primitives: for the generated "
                 "plants that 'meshes generated' writes")
      ->required();
  verb.output("-o,--output", a.output, "The scene's folder")->required()->type_name("SCENE");
  app.add_option("--ground", a.ground, "Model whose ground replaces the annotation's")
      ->type_name("MODEL");
  app.add_option("--nearest", a.compose.nearest,
                 "Draw each primitive among this many with the nearest boxes")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--scale", a.compose.scale, "Scale primitives to their boxes");
  app.add_option("--class-density", a.density,
                 "Objects for each annotated one of a class: below 1 leaves some out, above 1 adds "
                 "more beside them")
      ->type_name("CLASS=FACTOR ...");
  app.add_option("--leave-out", a.leave_out,
                 "Use no primitive that was cut from an object whose box overlaps one of this "
                 "annotation, as seen from above")
      ->type_name("ANNOTATION ...");
  app.add_flag("--allow-outside", a.allow_outside, kAllowOutsideHelp);
  app.add_flag("--strict", a.strict, "Fail if an object cannot be placed as annotated");
}

void read_densities(const Arguments& a, primitives::ComposeOptions& o) {
  for (const std::string& word : a.density) {
    const size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const auto label = elements::class_from_name(name);
    if (!label) {
      const std::string near =
          nearest_name(name, {elements::kClassNames.begin(), elements::kClassNames.end()});
      throw std::invalid_argument("compose: no class '" + name + "'" +
                                  (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    size_t used = 0;
    const std::string number = equals == std::string::npos ? "" : word.substr(equals + 1);
    double factor = -1;
    try {
      factor = std::stod(number, &used);
    } catch (const std::exception&) {
    }
    if (used == 0 || used != number.size() || !(factor >= 0 && factor <= 100)) {
      throw std::invalid_argument(
          "compose: expected CLASS=FACTOR with a factor in [0, 100], not '" + word + "'");
    }
    o.density[*label] = factor;
  }
}

/// Leaves the primitives of the annotations of `--leave-out` out of the set, and returns how many.
size_t leave_out(const Arguments& a, primitives::PrimitiveSet& set) {
  size_t out = 0;
  for (const std::string& file : a.leave_out) {
    out += primitives::leave_out(set, primitives::read_annotation(file, a.allow_outside).objects);
  }
  return out;
}

void require_all_placed(const Arguments& a, const primitives::Composition& c) {
  if (!a.strict) return;
  if (c.off_ground) {
    throw FormatError(a.annotation, "",
                      std::to_string(c.off_ground) + " objects stand off the ground mesh");
  }
  for (const auto& counts : {c.left_out, c.borrowed}) {
    if (counts.empty()) continue;
    throw FormatError(a.primitives, "",
                      "no primitives of the class " + counts.begin()->first + ", which " +
                          std::to_string(counts.begin()->second) + " objects have");
  }
}

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  read_densities(a, a.compose);
  elements::check_scene_output(a.output);
  const primitives::Annotation annotation =
      primitives::read_annotation(a.annotation, a.allow_outside);
  NamedSet named = primitives_named(a.primitives, verb.seed);
  const size_t left_out = leave_out(a, named.set);
  std::filesystem::path from = a.ground;
  if (from.empty()) from = annotation.ground.lexically_normal();
  const elements::Model ground = elements::read_model(from);
  if (ground.ground.size() == 0) throw FormatError(from.string(), "", "the model has no ground");
  a.compose.seed = verb.seed;
  primitives::Composition c = composed(annotation, ground, named.set, a.compose);
  require_all_placed(a, c);
  std::vector<std::filesystem::path> inputs{a.annotation};
  inputs.insert(inputs.end(), named.inputs.begin(), named.inputs.end());
  inputs.insert(inputs.end(), a.leave_out.begin(), a.leave_out.end());
  inputs.push_back(from);
  c.info.provenance = provenance(verb, inputs);
  elements::write_scene(a.output, c.scene, c.info);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  Json j = json_of(c);
  if (!a.leave_out.empty()) j["primitives_left_out"] = left_out;
  j["warnings"] = named.warnings;
  j["seconds"] = seconds;
  std::string text = text_of(c);
  if (!a.leave_out.empty()) {
    text += fmt::format("  left out    {} primitives of plants of {}\n", left_out,
                        fmt::join(a.leave_out, ", "));
  }
  text += text_of_warnings(named.warnings);
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
  add_options(*verb, *a);
}

}  // namespace underbrush::app
