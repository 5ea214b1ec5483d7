#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "list_results.hpp"
#include "osi_lists.hpp"
#include "perceived_grid.hpp"
#include "perceived_log.hpp"
#include "report/report.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace perceive_verb {
namespace fs = std::filesystem;
using perception::ExistenceRule;
using perception::HeadingSource;
using perception::ReferencePoint;

const std::map<std::string, ReferencePoint> kReferences{
    {"corner", ReferencePoint::kCorner},
    {"centre", ReferencePoint::kGeometricCentre},
    {"gravity", ReferencePoint::kCentreOfGravity}};
const std::map<std::string, ExistenceRule> kRules{{"probability", ExistenceRule::kProbability},
                                                  {"in-a-row", ExistenceRule::kInARow},
                                                  {"out-of", ExistenceRule::kOutOf}};

struct Arguments {
  std::string log, truth, rig, output, write_truth, report;
  std::string pipeline = "model", reference = "corner", heading = "points", rule = "probability";
  std::string ground = "cone";
  double truth_elevation_deg = 0, latency_ms = 0;
  bool as_measured = false, no_deskew = false;
  PerceptionSetup setup;
  GridSetup grid;
};

void add_existence_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  auto& e = a.setup.model.track.existence;
  verb.begin_rare_group("Existence");
  app.add_option("--existence", a.rule,
                 "When an object is listed: by its probability, after --needed cycles in a row "
                 "with points, or after --needed of --window cycles")
      ->check(CLI::IsMember({"probability", "in-a-row", "out-of"}))
      ->capture_default_str();
  app.add_option("--gain", e.step.gain, "Probability that a cycle with points adds")
      ->capture_default_str();
  app.add_option("--loss", e.step.loss, "Probability that a cycle without points subtracts")
      ->capture_default_str();
  app.add_option("--threshold", e.threshold, "Probability from which on an object is listed")
      ->capture_default_str();
  app.add_option("--start-points", e.step.start_points,
                 "An object that is not listed needs more points than this number")
      ->capture_default_str();
  app.add_option("--full-extent", e.full_extent_m,
                 "Segments that are smaller than this add less, m; 0 = all add the same")
      ->capture_default_str();
  app.add_option("--needed", e.needed, "Cycles with points")->capture_default_str();
  app.add_option("--window", e.window, "Cycles among which they are counted")
      ->capture_default_str();
  app.add_option("--lost", e.lost,
                 "Cycles without points after which an object is dropped; not by probability")
      ->capture_default_str();
}

void add_state_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  verb.begin_rare_group("State");
  app.add_option("--reference", a.reference, "The point that is tracked")
      ->check(CLI::IsMember({"corner", "centre", "gravity"}))
      ->capture_default_str();
  app.add_option("--heading", a.heading, "Where the tracking model takes headings from")
      ->check(CLI::IsMember({"points", "truth"}))
      ->capture_default_str();
  app.add_flag("--as-measured", a.as_measured,
               "Report boxes as the points show them, not completed by the sizes of the class");
  app.add_option("--ground", a.ground, "Ground removal of the real pipeline")
      ->check(CLI::IsMember({"cone", "lower_envelope"}))
      ->capture_default_str();
  app.add_option("--latency-ms", a.latency_ms, "Time from a cloud to its list, ms")
      ->capture_default_str();
  auto& r = a.setup.model.resolution;
  app.add_flag("--merge-close", r.enabled,
               "Merge objects of the tracking model that are nearer to each other than the sensor "
               "resolves");
  app.add_option("--merge-gap", r.least_gap_m, "Distance below which objects are always merged, m")
      ->capture_default_str();
  auto& g = a.setup.ghosts;
  app.add_option("--ghosts-per-s", g.rate_per_s, "Objects that do not exist, in each second")
      ->capture_default_str();
  app.add_option("--ghost-life", g.mean_life_s, "Mean life of such an object, s")
      ->capture_default_str();
}

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (ray cloud PLY)")->required();
  app.add_option("--truth", a.truth,
                 "The true objects: labelled boxes in the sensor's frame (CSV with frame and "
                 "track_id), or lists of objects in the world's frame (CSV, JSON, or an OSI "
                 "trace)")
      ->type_name("FILE");
  app.add_option("--pipeline", a.pipeline,
                 "The tracking model, which assigns points by the truth, or a real pipeline")
      ->check(CLI::IsMember({"model", "real"}))
      ->capture_default_str();
  verb.output("-o,--output", a.output, "The lists of objects: .json, .osi (SensorData), else CSV")
      ->type_name("OBJECTS");
  verb.output("--write-truth", a.write_truth,
              "The truth of each scan as lists: .json, .osi, else CSV")
      ->type_name("OBJECTS");
  verb.output("--report", a.report, "Write a report (one HTML file) into this folder",
              {"index.html"})
      ->type_name("DIR");
  verb.output(
          "--grid", a.grid.output,
          "Map free, permeable and solid cells around the vehicle: .png of the last cycle, else "
          "JSON of all")
      ->type_name("GRID");
  app.add_option("--rig", a.rig, "The sensors of the vehicle, for a log of several")
      ->type_name("RIG.yaml");
  app.add_option("--min-range", a.setup.cycles.min_range_m,
                 "Ignore hits nearer than this, m, such as those on the own vehicle")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--sensor-height", a.setup.cycles.sensor_height_m,
                 "Height of the sensor above the ground, m; the vehicle's frame stands there. A "
                 "rig's sensors have theirs")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--truth-elevation-deg", a.truth_elevation_deg,
                 "Turn labelled boxes up by this angle, as import turned the beams")
      ->capture_default_str();
  app.add_flag("--no-deskew", a.no_deskew, "Ignore the vehicle's motion within a cycle");
  add_existence_options(verb, a);
  add_state_options(verb, a);
  add_grid_options(verb, a.grid);
}

/// Completes the setup from the words of the command line.
PerceptionSetup setup_of(const Verb& verb, const Arguments& a) {
  PerceptionSetup s = a.setup;
  if (!a.rig.empty()) s.rig = perception::load_rig(a.rig);
  s.is_model = a.pipeline == "model";
  s.cycles.alignment.deskew = !a.no_deskew;
  s.model.track.reference = kReferences.at(a.reference);
  s.model.track.existence.rule = kRules.at(a.rule);
  s.model.track.completion.enabled = !a.as_measured;
  s.model.heading = a.heading == "truth" ? HeadingSource::kTruth : HeadingSource::kPoints;
  s.model.latency_s = s.real.latency_s = a.latency_ms / 1000;
  s.real.track = s.model.track;
  s.real.clusters.ground = a.ground;
  s.seed = verb.seed;
  return s;
}

Json json_of_run(const PerceivedLog& p) {
  Json j;
  j["cycles"] = p.lists.size();
  j["points"] = p.points;
  size_t objects = 0;
  for (const auto& list : p.lists) objects += list.objects.size();
  j["objects"] = objects;
  j["seconds"] = p.seconds;
  return j;
}

void check_outputs_of(const Arguments& a) {
  for (const std::string& path : {a.output, a.write_truth, a.grid.output}) {
    if (!path.empty()) io::check_output(path);
  }
  require(a.write_truth.empty() || !a.truth.empty(), "perceive: --write-truth needs --truth");
  require(a.report.empty() || !a.truth.empty(), "perceive: --report needs --truth");
  require(
      a.grid.output.empty() || !a.rig.empty() || a.setup.cycles.sensor_height_m > 0,
      "perceive: --grid needs the sensor's height above the ground (--sensor-height, or --rig)");
  if (!a.report.empty()) report::check_report_output(a.report);
}

void run(const Verb& verb, const Arguments& a) {
  check_outputs_of(a);
  const PerceptionSetup setup = setup_of(verb, a);
  io::LogReader log(a.log);
  std::optional<perception::LogTruth> truth;
  std::vector<fs::path> inputs{a.log};
  if (!a.truth.empty()) {
    truth = truth_of_log(a.truth, log.info(), {a.truth_elevation_deg * M_PI / 180});
    inputs.emplace_back(a.truth);
  }
  if (!a.rig.empty()) inputs.emplace_back(a.rig);
  const std::string origin = provenance(verb, inputs);
  std::optional<PerceivedGrid> grid;
  if (!a.grid.output.empty()) grid.emplace(a.grid, origin);
  const PerceivedLog p = perceived(log, truth ? &*truth : nullptr, setup, [&](const auto& cloud) {
    if (grid) grid->step(cloud);
  });
  if (!a.output.empty()) write_lists(a.output, p.lists, origin);
  if (!a.write_truth.empty()) write_lists(a.write_truth, p.truth, origin);
  if (grid) grid->close();
  Json j = json_of_run(p);
  std::string text = fmt::format("{} cycles: {} objects listed, {} points\n", p.lists.size(),
                                 j["objects"].get<size_t>(), p.points);
  text += fmt::format("  {:<11} {:.2f} s\n", a.pipeline, p.seconds);
  if (truth) {
    const std::vector<perception::ListScore> scores{perception::score_lists(p.lists, p.truth)};
    const std::vector<report::Table> tables{
        table_of("the truth", std::vector<std::string>{a.pipeline}, scores)};
    j["truth"] = json_of_list_score(scores[0]);
    text += "\n" + report::text_of(tables[0]);
    if (!a.report.empty()) {
      const std::vector<NamedLists> lists{{a.pipeline, p.lists}};
      text += "report: " +
              write_list_report(a.report, "Objects of " + fs::path(a.log).filename().string(),
                                {"truth", p.truth}, lists, tables, origin)
                  .string() +
              "\n";
    }
  }
  if (!a.output.empty()) text += "  objects     " + a.output + "\n";
  if (grid) {
    j["grid"] = grid->summary();
    text += "  grid        " + grid->text() + "\n";
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
