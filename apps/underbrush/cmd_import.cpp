#include <fmt/format.h>

#include <iostream>
#include <optional>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "report/world_text.hpp"
#include "stages.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/bounds.hpp"
#include "underbrush/pipeline/out_of_reach.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "underbrush/worlds/read_world.hpp"
#include "underbrush/worlds/survey_folder.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace import_verb {

constexpr int kWidth = 16;  // of a label

struct Arguments {
  std::string source, output;
  pipeline::ImportOptions options;
};

std::string text_of(const io::ScanClock& clock) {
  std::string text =
      wide_line(kWidth, "clock",
                "times rounded to {:g} ms; period {:.1f} ms, residual {:.1f} ms RMS; poses {}",
                1e3 * clock.step_s, 1e3 * clock.period_s, 1e3 * clock.residual_rms_s,
                clock.poses_follow ? "follow it" : "keep their times");
  if (clock.kept > 0) {
    text += fmt::format("  note: no steady clock explains the times of {} scans: left as given\n",
                        clock.kept);
  }
  return text;
}

std::string text_of(const pipeline::ImportReport& r, const std::string& output) {
  std::string text =
      fmt::format("{} ({}): {} scans, {} beams\n", output, r.format, r.scans, r.beams);
  const auto add = [&](std::string_view label, size_t n, std::string_view note) {
    text += note.empty() ? wide_line(kWidth, label, "{}", n)
                         : wide_line(kWidth, label, "{}  ({})", n, note);
  };
  add("hits", r.beam.hits, "");
  add("misses recorded", r.beam.misses_recorded, "");
  add("misses inferred", r.beam.misses_inferred, "");
  add("unknown", r.beam.unknown, "beams without a known end: left out");
  if (r.later_returns > 0) {
    add("later returns", r.later_returns,
        "of the same pulses; fit reads the first ones, or all with --echoes all");
  }
  for (const auto& [reason, n] : r.skipped) add("skipped", n, reason);
  if (r.beam.scans_ringed_by_elevation > 0) {
    text += fmt::format("  note: rings of {} scans determined from elevations\n",
                        r.beam.scans_ringed_by_elevation);
  }
  if (r.beam.scans_with_rings_renumbered > 0) {
    text += fmt::format(
        "  note: rings of {} scans have other numbers than the sensor's channels, "
        "and got those\n",
        r.beam.scans_with_rings_renumbered);
  }
  if (r.clock) text += text_of(*r.clock);
  for (const std::string& note : r.notes) text += "  note: " + note + "\n";
  return text + text_of_warnings(r.warnings);
}

/// Says which legs cannot be where the scene is.
std::vector<std::string> warnings_of(const worlds::World& world, const worlds::Survey& survey) {
  std::vector<std::string> warnings;
  const metrics::Bounds scene = metrics::bounds_of(world.scene.models, world.scene.instances);
  for (const worlds::SurveyLeg& leg : survey.legs) {
    metrics::Bounds path;
    for (const StampedPose& p : leg.trajectory.poses()) path.add(p.world_from_sensor.translation);
    const std::string text = pipeline::other_coordinates(path, scene);
    if (!text.empty()) warnings.push_back(fmt::format("leg {}: {}", leg.number, text));
  }
  return warnings;
}

/// Writes a survey of HELIOS++ as a folder.
void import_survey(const Verb& verb, const Arguments& a) {
  worlds::check_survey_output(a.output);
  const worlds::World world = worlds::read_helios_scene(a.source, "", a.options.assets);
  const worlds::Survey survey = worlds::read_helios_survey(
      a.source, [&](double x, double y) { return worlds::ground_at(world, x, y); },
      a.options.assets);
  Json j =
      io::json_of_text(worlds::write_survey(a.output, world, survey, provenance(verb, {a.source})));
  const report::WorldSummary summary{world.report, world.info};
  j["world"] = json_of(summary);
  std::string text = fmt::format("{}: survey of {} legs on which the scanner measures\n", a.source,
                                 survey.legs.size());
  text += text_of(summary);
  for (const auto& [what, n] : survey.left_out) {
    text += line("left out", "{} ({})", n, what);
  }
  const std::vector<std::string> warnings = warnings_of(world, survey);
  if (!warnings.empty()) j["warnings"] = warnings;
  text += text_of_warnings(warnings);
  text += line("survey", "{}", a.output);
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
  // Without a sensor nobody has said how far it reaches.
  const bool measured =
      a.options.max_range_m == 0 && a.options.deskew.empty() && a.options.infer_misses.empty();
  const pipeline::ImportReport report = pipeline::import_log(
      a.source, a.options,
      [&](const LogInfo& info) {
        writer.emplace(a.output, info, provenance(verb, inputs),
                       io::LogWriterOptions{!a.options.float_coordinates, measured});
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
               "Convert any supported log to a log of beams, with misses kept or inferred",
               "underbrush import drive/ --poses drive/poses_velo.txt --deskew velodyne-hdl64e \\\n"
               "    --elevation-offset-deg 0.205 --infer-misses velodyne-hdl64e -o log.ply",
               [a](const Verb& v) { run(v, *a); });
  verb->app
      .add_option("SOURCE", a->source, "The log: a file or folder; or a survey of HELIOS++ (.xml)")
      ->required();
  verb->output("-o,--output", a->output,
               "The log, a ray cloud (.ply) or compact (.ublog); for a survey, a folder")
      ->required()
      ->type_name("LOG.ply");
  add_options(*verb, pipeline::import_options(), a->options);
}

}  // namespace underbrush::app
