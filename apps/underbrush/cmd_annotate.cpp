#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {
namespace annotate_verb {

struct Arguments {
  std::string log, output, ground;
  pipeline::AnnotateOptions options;
};

std::string text_of(const primitives::MeasuredObjects& measured, const Json& j) {
  std::string text = fmt::format("{} objects\n", measured.objects.size());
  if (measured.objects.empty()) {
    text += line("warning", "nothing stands on this ground");
  } else {
    for (const auto& [name, n] : j["classes"].items()) {
      text += wide_line(18, name, "{:>8}", n.get<size_t>());
    }
  }
  return text + left_out(measured.few_points, "objects or cells of few points") +
         left_out(measured.off_ground, "objects off the ground") +
         left_out(measured.without_instance, "hits of an object's class without instance");
}

void run_parts(const Verb& verb, const Arguments& a) {
  require(a.log.empty() && a.ground.empty(), "annotate: --parts is for a generated ground");
  const regions::GeneratedSite site = pipeline::generate_parts(
      a.output, a.options, provenance(verb, {}), shown<Progress>("annotate"));
  const Json j = pipeline::json_of(site);
  std::string text = fmt::format("{} objects\n", j["objects"].get<size_t>());
  for (const auto& [name, n] : j["classes"].items()) {
    text += wide_line(18, name, "{:>8}", n.get<size_t>());
  }
  verb.report(j, text + line("ground", "{} triangles", site.triangles) +
                     line("site", "{}: {} parts", a.output, site.parts));
}

void run(const Verb& verb, Arguments& a) {
  a.options.site.seed = verb.seed;
  if (a.options.part_m > 0) return run_parts(verb, a);
  const fs::path output = a.output;
  const fs::path ground = a.ground.empty()
                              ? output.parent_path() / (output.stem().string() + ".ground")
                              : fs::path(a.ground);
  io::check_output(output);
  if (a.ground.empty()) elements::check_model_output(ground);
  std::optional<io::LogReader> log;
  if (!a.log.empty()) log.emplace(a.log);
  pipeline::AnnotatedSite site = pipeline::annotate_site(a.log, log ? &*log : nullptr, a.ground,
                                                         a.options, shown<StageProgress>());
  const Json j = pipeline::json_of(site.measured);
  const std::string text =
      text_of(site.measured, j) +
      line("ground", "{} ({} triangles)", ground.string(), site.ground.ground.size());
  pipeline::write_annotated(output, ground, std::move(site), provenance(verb, {a.log, a.ground}));
  verb.report(j, text + line("annotation", "{}", a.output));
}

}  // namespace annotate_verb
}  // namespace

void add_annotate(Program& program) {
  using namespace annotate_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "annotate",
      "List the objects of a site, from a labelled log or generated at random",
      "underbrush annotate labelled.ply -o annotation.json\n"
      "  underbrush annotate --generate savanna --density 0.005 --seed 7 -o annotation.json\n"
      "  underbrush annotate --generate forest --ground model/ -o annotation.json",
      [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("LABELLED", a->log, "The site's log, labelled by segment");
  verb->output("-o,--output", a->output, "The annotation file; with --parts, a folder")
      ->required()
      ->type_name("ANNOTATION.json");
  verb->app
      .add_option(
          "--ground", a->ground,
          "Model whose ground the objects stand on; by default the ground is made from the log's "
          "ground points, or generated, as the folder STEM.ground beside the annotation")
      ->type_name("MODEL");
  add_options(*verb, pipeline::annotate_options(), a->options, "Generated site");
}

}  // namespace underbrush::app
