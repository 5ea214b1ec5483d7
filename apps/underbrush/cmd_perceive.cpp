#include <cmath>
#include <optional>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "report/object_lists.hpp"
#include "report/report.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/perception/grid_file.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace perceive_verb {
namespace fs = std::filesystem;
using perception::CellLabel;

struct Arguments {
  std::string log, output, write_truth, report, grid;
  perception::PerceiveOptions options;
};

void add_options(Verb& verb, Arguments& a) {
  verb.app.add_option("LOG", a.log, "The log (.ply or .ublog)")->required();
  const auto table = perception::perceive_options();
  app::add_options(verb, table.first(2), a.options);
  verb.output("-o,--output", a.output, "The lists of objects: .json, .osi (SensorData), or CSV")
      ->type_name("OBJECTS");
  verb.output("--write-truth", a.write_truth,
              "The true objects of each scan as lists: .json, .osi, or CSV")
      ->type_name("OBJECTS");
  add_report_option(verb, a.report);
  verb.output(
          "--grid", a.grid,
          "Write a map of free, permeable and solid cells around the vehicle: the last cycle as "
          ".png, or else all cycles as JSON")
      ->type_name("GRID");
  app::add_options(verb, table.subspan(2), a.options);
}

void check_outputs_of(const Arguments& a) {
  for (const std::string& path : {a.output, a.write_truth, a.grid}) {
    if (!path.empty()) io::check_output(path);
  }
  for (const std::string& path : {a.output, a.write_truth}) osi::check_list_name(path);
  require(a.write_truth.empty() || !a.options.truth.empty(),
          "perceive: --write-truth needs --truth");
  require(a.report.empty() || !a.options.truth.empty(), "perceive: --report needs --truth");
  if (!a.report.empty()) report::check_report_output(a.report);
}

/// Writes the report, if one is asked for, and returns the scores against the truth as text.
std::string text_of_scores(const Arguments& a, const perception::PerceivedLog& p,
                           const std::string& origin) {
  const std::vector<report::Table> tables{report::table_of(
      "the truth", std::vector<std::string>{a.options.pipeline},
      std::vector<perception::ListScore>{perception::score_lists(p.lists, p.truth)})};
  std::string text = "\n" + report::text_of(tables[0]);
  if (a.report.empty()) return text;
  const std::vector<report::NamedLists> lists{{a.options.pipeline, p.lists}};
  const fs::path page =
      report::write_list_report(a.report, "Objects of " + fs::path(a.log).filename().string(),
                                {"truth", p.truth}, lists, tables, origin);
  return text + "report: " + page.string() + "\n";
}

void run(const Verb& verb, Arguments& a) {
  check_outputs_of(a);
  a.options.setup.seed = verb.seed;
  io::LogReader log(a.log);
  std::optional<perception::LogTruth> truth;
  if (!a.options.truth.empty()) {
    truth = osi::truth_of_log(a.options.truth, log.info(),
                              {a.options.truth_elevation_deg * M_PI / 180});
  }
  const std::string origin = provenance(verb, {a.log, a.options.truth, a.options.rig});
  const pipeline::GridFile grid{a.grid, origin};
  const pipeline::Perceived perceived = pipeline::perceive_log(
      log, truth ? &*truth : nullptr, a.options, a.grid.empty() ? nullptr : &grid);
  const perception::PerceivedLog& p = perceived.log;
  if (!a.output.empty()) osi::write_lists(a.output, p.lists, origin);
  if (!a.write_truth.empty()) osi::write_lists(a.write_truth, p.truth, origin);
  const Json j = json_of(perceived);
  std::string text = fmt::format("{} cycles: {} objects listed, {} points\n", p.lists.size(),
                                 j["objects"].get<size_t>(), p.points);
  text += line(a.options.pipeline, "{:.2f} s", p.seconds);
  if (truth) text += text_of_scores(a, p, origin);
  if (!a.output.empty()) text += line("objects", "{}", a.output);
  if (const auto& g = perceived.grid) {
    const auto area = [&](CellLabel label) { return g->area_m2[size_t(label)]; };
    text += line(
        "grid", "{}: at the end {:.0f} m² free, {:.0f} permeable, {:.0f} solid; {:.1f} ms a cycle",
        a.grid, area(CellLabel::kFree), area(CellLabel::kPermeable), area(CellLabel::kSolid),
        1000 * g->seconds / double(std::max<size_t>(1, g->cycles)));
  }
  verb.report(j, text);
}

}  // namespace perceive_verb
}  // namespace

void add_perceive(Program& program) {
  using namespace perceive_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Simulation", "perceive", "Turn a log into lists of tracked objects",
      "underbrush perceive log.ply --truth objects.csv -o objects.json --report report/\n"
      "  underbrush perceive log.ply --pipeline real -o objects.csv\n"
      "  underbrush perceive log.ply --pipeline real --grid grid.png --sensor-height 1.73\n"
      "  underbrush perceive rig.ply --rig rig.yaml --truth truth.json -o objects.csv",
      [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
