#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "underbrush/primitives/primitive_set.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace extract_verb {

constexpr size_t kPoor = 3;  // elements

struct Arguments {
  std::string model, log, output;
  pipeline::ExtractOptions options;
};

std::string text_of(const primitives::ExtractResult& r, const Json& j) {
  std::string text =
      fmt::format("{} primitives hold {} of {} elements ({:.1f} %)\n", r.primitives.size(), r.taken,
                  r.elements, 100.0 * double(r.taken) / double(std::max<size_t>(1, r.elements)));
  for (const auto& [name, n] : j["classes"].items()) {
    const auto primitives = n["primitives"].get<size_t>();
    text += wide_line(18, name, "{:>8}, {:.0f} elements each", primitives,
                      n["elements"].get<double>() / double(primitives));
  }
  const auto poor = std::count_if(r.primitives.begin(), r.primitives.end(),
                                  [](const auto& p) { return p.model.size() < kPoor; });
  if (poor > 0) {
    text += fmt::format(
        "  note: {} of them have fewer than {} elements and hardly look like a plant; "
        "--min-elements leaves such out\n",
        poor, kPoor);
  }
  return text + left_out(r.free_space, "ellipsoids of free space") +
         left_out(r.empty, "objects without an element") +
         left_out(r.few_elements, "objects or cells of few elements") +
         left_out(r.measured.few_points, "objects or cells of few points") +
         left_out(r.measured.off_ground, "objects off the ground") +
         left_out(r.measured.without_instance, "hits of an object's class without instance");
}

void run(const Verb& verb, const Arguments& a) {
  io::BeamReader log(a.log);
  primitives::require_objects(a.log, log);
  const elements::Model model = pipeline::read_model_along(a.model, log, a.options);
  primitives::check_primitives_output(a.output);
  const primitives::ExtractResult r =
      pipeline::extract_primitives(model, a.log, log, a.options, shown<Progress>("extract"));
  primitives::write_primitives(a.output, r.primitives, a.options.cut.measure.cell_m,
                               provenance(verb, {a.model, a.log}));
  const Json j = pipeline::json_of(r);
  verb.report(j, text_of(r, j) + lines_of_set(a.output));
}

}  // namespace extract_verb
}  // namespace

void add_extract(Program& program) {
  using namespace extract_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "extract", "Cut primitives out of a model along a labelled log",
      "underbrush extract model/ labelled.ply -o primitives/", [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("MODEL", a->model, "The folder of a model or its world of regions")
      ->required();
  verb->app
      .add_option("LABELLED", a->log, "The log that the model was fitted to, labelled by segment")
      ->required();
  verb->output("-o,--output", a->output, "The folder of the set of primitives")
      ->required()
      ->type_name("PRIMITIVES");
  add_options(*verb, pipeline::extract_options(), a->options);
}

}  // namespace underbrush::app
