#include <fmt/format.h>

#include <iostream>
#include <optional>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "import_report.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_file.hpp"
#include "underbrush/worlds/read_world.hpp"
#include "underbrush/worlds/survey_folder.hpp"
#include "verbs.hpp"
#include "world_summary.hpp"

namespace underbrush::app {
namespace {
namespace import_verb {

struct Arguments {
  std::string source, output;
  pipeline::ImportOptions options;
};

/// Writes a survey of HELIOS++ as a folder.
void import_survey(const Verb& verb, const Arguments& a) {
  worlds::check_survey_output(a.output);
  const worlds::World world = worlds::read_helios_scene(a.source, "", a.options.assets);
  const worlds::Survey survey = worlds::read_helios_survey(
      a.source, [&](double x, double y) { return worlds::ground_at(world, x, y); },
      a.options.assets);
  Json j =
      io::json_of_text(worlds::write_survey(a.output, world, survey, provenance(verb, {a.source})));
  const WorldSummary summary{world.report, world.info};
  j["world"] = json_of(summary);
  std::string text = fmt::format("{}: survey of {} legs on which the scanner measures\n", a.source,
                                 survey.legs.size());
  text += text_of(summary);
  for (const auto& [what, n] : survey.left_out) {
    text += fmt::format("  left out    {} ({})\n", n, what);
  }
  text += fmt::format("  survey      {}\n", a.output);
  const std::string folder = std::filesystem::path(a.output).lexically_normal().string();
  for (size_t k = 0; k < survey.legs.size() && k < 8; ++k) {
    text += fmt::format(
        "  underbrush simulate {0}/scene --sensor {0}/leg-{1}.yaml --trajectory {0}/leg-{1}.txt -o "
        "leg-{1}.ply\n",
        folder, survey.legs[k].number);
  }
  verb.report(j, text);
}

void run(const Verb& verb, const Arguments& a) {
  if (worlds::is_helios(a.source)) return import_survey(verb, a);
  std::vector<std::filesystem::path> inputs = a.options.files();
  inputs.insert(inputs.begin(), a.source);
  std::optional<io::LogWriter> writer;
  const pipeline::ImportReport report = pipeline::import_log(
      a.source, a.options,
      [&](const LogInfo& info) {
        writer.emplace(a.output, info, provenance(verb, inputs),
                       io::LogWriterOptions{!a.options.float_coordinates});
      },
      [&](const BeamLog& beams) { writer->write(beams); }, shown<Progress>("import"));
  writer->close();
  for (const std::string& w : report.warnings) std::cerr << "underbrush: warning: " << w << "\n";
  verb.report(json_of(report), text_of(report, a.output));
}

}  // namespace import_verb
}  // namespace

void add_import(Program& program) {
  using namespace import_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Logs", "import",
               "Convert any supported log to a ray cloud PLY, with misses kept or inferred",
               "underbrush import drive/ --poses drive/poses_velo.txt --deskew velodyne-hdl64e \\\n"
               "    --elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e -o log.ply",
               [a](const Verb& v) { run(v, *a); });
  verb->app
      .add_option("SOURCE", a->source, "The log: a file or folder; or a survey of HELIOS++ (.xml)")
      ->required();
  verb->output("-o,--output", a->output, "The log as a ray cloud PLY; of a survey, a folder")
      ->required()
      ->type_name("LOG.ply");
  add_options(*verb, pipeline::import_options(), a->options);
}

}  // namespace underbrush::app
