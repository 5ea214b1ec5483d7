#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "segment_report.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace segment_verb {

struct Arguments {
  std::string log, output;
  pipeline::SegmentOptions options;
};

void run(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.log);
  if (!a.output.empty()) io::check_output(a.output);
  std::vector<std::filesystem::path> inputs{a.log};
  if (!a.options.labels.empty()) inputs.emplace_back(a.options.labels);
  std::function<void(BeamSource&)> write;
  if (!a.output.empty()) {
    write = [&](BeamSource& labelled) {
      io::export_log(a.output, labelled, "ply", provenance(verb, inputs));
    };
  }
  const pipeline::Segmentation s =
      pipeline::segment_log(log, a.options, write, shown<StageProgress>());
  std::string text = text_of(s, a.options);
  if (!a.output.empty()) text += "  log         " + a.output + "\n";
  verb.report(json_of(s, a.options, log.skipped()), text);
}

}  // namespace segment_verb
}  // namespace

void add_segment(Program& program) {
  using namespace segment_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Scenes", "segment",
               "Label a log as ground, trees, shrubs and patches, or take labels from a file",
               "underbrush segment log.ply -o labelled.ply\n"
               "  underbrush segment log.ply --labels edited.ply -o labelled.ply\n"
               "  underbrush segment log.ply --ground-method spherical_variance --json -",
               [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("LOG", a->log, "The log (ray cloud PLY, as import writes it)")->required();
  verb->output("-o,--output", a->output,
               "The log with the columns class and instance; columns of these names that it has "
               "already are kept as given_class and given_instance, for comparison")
      ->type_name("LABELLED.ply");
  add_options(*verb, pipeline::segment_options(), a->options);
}

}  // namespace underbrush::app
