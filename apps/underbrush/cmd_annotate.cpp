#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/annotate_site.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "underbrush/primitives/annotation.hpp"
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
  for (const Json& s : j.value("statistics", Json::array())) {
    const auto value = [&](const char* of) { return s[of].is_null() ? NAN : s[of].get<double>(); };
    text += wide_line(54, s["name"].get<std::string>(),
                      "{:.3g}, like it {:.3g} ({:.3g} to {:.3g}) {}", value("site"), value("mean"),
                      value("low"), value("high"), s["unit"].get<std::string>());
  }
  for (const char* what : {"replaced", "left_out"}) {
    const Json counts = j.value(what, Json::object());
    for (const auto& [name, n] : counts.items()) {
      text += line("note", "{} of class {}, which has no primitives: {}", n.get<size_t>(), name,
                   what == std::string_view("replaced") ? "of another size" : "left out");
    }
  }
  return text + left_out(measured.few_points, "objects or cells of few points") +
         left_out(measured.off_ground, "objects off the ground") +
         left_out(j.value("objects_off_ground", size_t(0)), "objects off the ground") +
         left_out(j.value("missing_cells", size_t(0)), "cells of patches without room") +
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
  const Json j = pipeline::json_of(site);
  const std::string text =
      text_of(site.measured, j) +
      line("ground", "{} ({} triangles)", ground.string(), site.ground.ground.size());
  std::vector<fs::path> inputs = site.inputs;
  inputs.insert(inputs.end(), {a.log, a.ground});
  // The site that --like names may have its ground where this one gets its own.
  if (site.has_own_ground) check_outputs({{"the ground", ground}}, site.inputs, verb.force);
  const primitives::Annotation annotation{ground, std::move(site.measured.objects),
                                          provenance(verb, inputs)};
  if (site.has_own_ground) {
    primitives::write_annotation(output, annotation, std::move(site.ground));
  } else {
    primitives::write_annotation(output, annotation);
  }
  verb.report(j, text + line("annotation", "{}", a.output));
}

}  // namespace annotate_verb
}  // namespace

void add_annotate(Program& program) {
  using namespace annotate_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "annotate", "List the objects of a site: of a labelled log, or generated",
      "underbrush annotate labelled.ply -o annotation.json\n"
      "  underbrush annotate --generate savanna --density 0.005 --seed 7 -o annotation.json\n"
      "  underbrush annotate --generate --like site.json --primitives primitives/ -o new.json",
      [a](const Verb& v) { run(v, *a); });
  verb->app.add_option("LABELLED", a->log, "The site's log, labelled by segment");
  verb->output("-o,--output", a->output, "The annotation file; with --parts, a folder")
      ->required()
      ->type_name("ANNOTATION.json");
  verb->app
      .add_option(
          "--ground", a->ground,
          "Model on whose ground the objects stand; by default, a ground is fitted to the log or "
          "generated, and written to STEM.ground beside the annotation")
      ->type_name("MODEL");
  add_options(*verb, pipeline::annotate_options(), a->options, "Generated site");
  verb->app.get_option("--generate")->expected(0, 1);
}

}  // namespace underbrush::app
