#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "objects_report.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace extract_verb {

struct Arguments {
  std::string model, log, output;
  pipeline::ExtractOptions options;
};

void run(const Verb& verb, const Arguments& a) {
  const elements::Model model = elements::read_model(a.model);
  io::BeamReader log(a.log);
  primitives::check_primitives_output(a.output);
  const primitives::ExtractResult r =
      pipeline::extract_primitives(model, a.log, log, a.options, shown<Progress>("extract"));
  primitives::write_primitives(a.output, r.primitives, a.options.cut.measure.cell_m,
                               provenance(verb, {a.model, a.log}));
  verb.report(json_of(r), text_of(r) + "  primitives  " + a.output + "\n  to look at  " +
                              (std::filesystem::path(a.output) / "index.html").string() + "\n");
}

}  // namespace extract_verb
}  // namespace

void add_extract(Program& program) {
  using namespace extract_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "extract", "Cut primitives out of a model along a labelled log",
      "underbrush extract model/ labelled.ply -o primitives/", [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("MODEL", a->model, "The model's folder")->required();
  verb->app
      .add_option("LABELLED", a->log, "The log that the model was fitted to, labelled by segment")
      ->required();
  verb->output("-o,--output", a->output, "The folder of the set of primitives")
      ->required()
      ->type_name("PRIMITIVES");
  add_options(*verb, pipeline::extract_options(), a->options);
}

}  // namespace underbrush::app
