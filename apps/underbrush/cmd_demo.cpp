#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <optional>

#include "cli/progress.hpp"
#include "report/report.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/import_log.hpp"
#include "underbrush/pipeline/score_json.inl"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/pipeline/split_log.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"
#include "underbrush/test_site/test_site.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace demo_verb {
namespace fs = std::filesystem;

struct Arguments {
  std::string output = "demo", sensor = "velodyne-hdl32e", only;
  test_site::SiteParameters site;
  simulate::FootprintOptions beam;
};

constexpr double kSpeedMS = 7;  // fewer scans than at a walker's speed, in less time

constexpr const char* kSynthetic =
    "Synthetic data: a generated site of fine triangles, scanned by a beam with divergence, stands "
    "in for reality. Nothing here was measured.";
constexpr const char* kReal =
    "Real data: one scan of an Ouster OS0-128 in a forest (ROUGH data set, Czech Technical "
    "University in Prague, BSD-3-Clause). The models are fitted to its even columns and scored on "
    "the odd ones.";
constexpr const char* kNoExample =
    "not found beside the program; UNDERBRUSH_SHARE may name the folder that holds examples/";

// The scan, below the folder of files that travel with the program.
constexpr const char* kExampleScan = "examples/marv_forest.pcd";

// Lower beams without a return were blocked by the robot that carried the sensor.
constexpr double kUnknownBelowDeg = -13;

std::vector<fs::path> shares() {
  if (const char* given = std::getenv("UNDERBRUSH_SHARE")) return {given};
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  const fs::path parent = program.parent_path().parent_path();
  return {parent / "share/underbrush", parent.parent_path() / "share"};
}

// Finds the file of the example scan. It is searched in the folder that the environment variable
// UNDERBRUSH_SHARE names or, where that is not set, in share/underbrush/ beside an installed
// program's bin/, or in share/ of the source tree that holds the program's build folder. The
// result is empty if the file does not exist.
std::optional<fs::path> example_scan() {
  for (const fs::path& share : shares()) {
    std::error_code none;
    if (fs::is_regular_file(share / kExampleScan, none)) return share / kExampleScan;
  }
  return std::nullopt;
}

// Imports the scan to `folder`/log.ply and splits it: its odd columns go to test.ply, the others
// to train.ply. Returns the number of beams.
size_t import_example(const Verb& verb, const fs::path& scan, const fs::path& folder) {
  const fs::path file = folder / "log.ply";
  pipeline::ImportOptions options;
  options.unknown_below_deg = kUnknownBelowDeg;
  std::optional<io::LogWriter> imported;
  pipeline::import_log(
      scan, options,
      [&](const LogInfo& info) { imported.emplace(file, info, provenance(verb, {scan})); },
      [&](const BeamLog& beams) { imported->write(beams); });
  imported->close();
  pipeline::SplitOptions odd_columns;
  odd_columns.columns = 2;
  io::LogReader log(file);
  const std::string origin = provenance(verb, {file});
  io::LogWriter train(folder / "train.ply", log.info(), origin);
  io::LogWriter test(folder / "test.ply", log.info(), origin);
  const pipeline::SplitCounts n =
      pipeline::split_log(log, odd_columns, [&](const BeamLog& even, const BeamLog& odd) {
        train.write(even);
        test.write(odd);
      });
  train.close();
  test.close();
  return n.train_beams + n.test_beams;
}

/// Replaces the column `element` by `instance`: the plant that was hit, 0 for ground and misses.
void add_instances(const test_site::FlatSite& flat, BeamLog& beams) {
  auto& element = std::get<std::vector<uint32_t>>(beams.extra.at("element"));
  for (uint32_t& e : element) e = e < flat.instance.size() ? flat.instance[e] : 0;
  beams.extra["instance"] = std::move(element);
  beams.extra.erase("element");
}

/// Scans the site along its drive and writes even scans to `train`, odd ones to `test`. Returns the
/// number of beams.
size_t scan_site(const Verb& verb, const Arguments& a, const fs::path& train,
                 const fs::path& test) {
  const test_site::Site site = test_site::make_site(a.site);
  const test_site::FlatSite flat = test_site::flatten(site);
  const trace::World world(flat.model);
  const sensor::Sensor sensor = sensor::load(a.sensor);
  const auto& poses = site.world_from_sensor.poses();
  sensor::PatternSource pattern(sensor, site.world_from_sensor, poses.front().time_s,
                                poses.back().time_s);
  LogInfo info = pattern.info();
  info.has_misses = true;
  info.classes = "underbrush";
  const std::string origin = provenance(verb, {});
  io::LogWriter writers[2] = {{train, info, origin}, {test, info, origin}};
  Progress progress("scan the site");
  BeamLog chunk;
  size_t done = 0;
  while (pattern.next(chunk)) {
    simulate::scan(world, flat.label, a.beam, done, chunk);
    add_instances(flat, chunk);
    BeamLog part[2] = {chunk.like(), chunk.like()};
    for (size_t begin = 0, end; begin < chunk.size(); begin = end) {
      const uint32_t odd = chunk.scan[begin] & 1;
      for (end = begin + 1; end < chunk.size() && (chunk.scan[end] & 1) == odd;) ++end;
      part[odd].append(chunk, begin, end);
    }
    for (int k = 0; k < 2; ++k) writers[k].write(part[k]);
    progress(done += chunk.size(), pattern.size());
  }
  for (io::LogWriter& w : writers) w.close();
  return done;
}

/// Lines of progress, with the time since the start.
class Diary {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  void operator()(const std::string& line) const {
    std::cerr << fmt::format("[{:5.1f} s] {}\n", seconds(), line) << std::flush;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Two models of one log, scored.
struct Part {
  std::string title, note;
  fs::path test;
  std::vector<Candidate> candidates;
  pipeline::Scores scores;
  Json results;

  report::Comparison comparison() const {
    report::Comparison c{title, note, results, test, {}};
    for (const Candidate& m : candidates) c.simulated.push_back({m.name, m.log});
    return c;
  }
  std::string table() const { return title + "\n" + text_of_scores(scores); }
};

/// Answers the beams of a log as `simulate` does without options, and returns their number.
size_t simulate_like(const Verb& verb, const elements::Model& model, BeamSource& like,
                     const fs::path& output, const std::vector<fs::path>& inputs) {
  pipeline::SimulateOptions options;
  options.seed = verb.seed;
  const pipeline::TracedWorld world(model, pipeline::matter_of(options));
  pipeline::Simulation simulation(world, options);
  const std::string origin = provenance(verb, inputs);
  Progress progress("simulate");
  return pipeline::simulate_log(
             simulation, like, [&](BeamSource& log) { io::export_log(output, log, "", origin); },
             std::ref(progress))
      .beams;
}

/// Fits the default and a surface mesh to `folder`/train.ply, and scores both on `folder`/test.ply.
void fit_and_score(const Verb& verb, const Diary& say, const fs::path& folder, Part& part) {
  const fs::path train = folder / "train.ply";
  part.test = folder / "test.ply";
  std::vector<fs::path> inputs{part.test};
  for (const char* fitter : {"likelihood", "surface"}) {
    fit::FitOptions options;
    options.fitter = fitter;
    options.seed = verb.seed;
    const fs::path model = folder / fitter, log = folder / (std::string(fitter) + ".ply");
    elements::check_model_output(model);
    const auto beams = pipeline::open_log(train, true);
    const pipeline::FittedModel fitted =
        pipeline::fit_model({*beams, {train}}, options, std::bind_front(&Verb::provenance, &verb),
                            shown<StageProgress>());
    pipeline::write_trained(model, fitted);
    io::LogReader like(part.test);
    const elements::Model& m = fitted.model;
    const size_t simulated = simulate_like(verb, m, like, log, {model, part.test});
    say(fmt::format("{}: fitted {} ellipsoids, {} triangles ({:.1f} s), simulated {} beams", fitter,
                    m.ellipsoids.size(), m.ground.size() + m.surface.size(), fitted.seconds,
                    simulated));
    part.candidates.push_back({fitter, log, model});
    inputs.push_back(log);
  }
  part.scores = score_logs(part.test, train, part.candidates);
  inputs.push_back(train);
  part.results = pipeline::json_of_scores(part.scores, provenance(verb, inputs));
}

Part site_part(const Verb& verb, const Diary& say, const Arguments& a) {
  const fs::path folder = a.output;
  say(kSynthetic);
  const size_t beams = scan_site(verb, a, folder / "train.ply", folder / "test.ply");
  say(fmt::format("scanned the site with {}: {} beams; even scans train, odd scans are held out",
                  a.sensor, beams));
  Part part{"Synthetic: a generated site", kSynthetic, {}, {}, {}, {}};
  fit_and_score(verb, say, folder, part);
  say("scored on the held-out scans");
  return part;
}

Part real_part(const Verb& verb, const Diary& say, const fs::path& scan, const fs::path& folder) {
  fs::create_directories(folder);
  say(kReal);
  const size_t beams = import_example(verb, scan, folder);
  say(fmt::format("imported {}: {} beams; even columns train, odd columns are held out",
                  scan.filename().string(), beams));
  Part part{"Real: one scan under trees", kReal, {}, {}, {}, {}};
  fit_and_score(verb, say, folder, part);
  say("scored on the held-out columns");
  return part;
}

void run(const Verb& verb, Arguments& a) {
  const Diary say;
  const fs::path folder = a.output;
  const std::optional<fs::path> scan = a.only == "site" ? std::nullopt : example_scan();
  if (!scan && a.only == "real") throw FormatError(kExampleScan, "", kNoExample);
  fs::create_directories(folder);
  a.site.seed = a.beam.seed = verb.seed;
  a.site.drive.speed_m_s = kSpeedMS;
  a.beam.element_ids = true;
  std::optional<Part> site, real;
  if (a.only != "real") site = site_part(verb, say, a);
  if (scan) real = real_part(verb, say, *scan, folder / "real");
  if (!scan && a.only.empty()) say(fmt::format("no real scan: {}: {}", kExampleScan, kNoExample));

  report::ReportInput report{
      "Underbrush demo", "Models learnt from one half of a log, scored on the other half.", {}};
  Json results = Json::object();
  std::string text;
  if (site) {
    results = site->results;
    results["synthetic"] = true;
  }
  if (real) {
    results["real"] = real->results;
    results["real"]["synthetic"] = false;
  }
  for (const std::optional<Part>* part : {&site, &real}) {
    if (!*part) continue;
    report.comparisons.push_back((*part)->comparison());
    text += (*part)->table();
  }
  const fs::path page = report::write_report(folder / "report", report);
  results["seconds"] = say.seconds();
  verb.report(results, text + fmt::format("report: {}\n", page.string()));
}

}  // namespace demo_verb
}  // namespace

void add_demo(Program& program) {
  using namespace demo_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Start", "demo",
               "Run the whole pipeline on a generated site and on a real scan, and write a report",
               "underbrush demo -o demo/\n  underbrush demo --only real",
               [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  verb->output("-o,--output", a->output, "Folder for everything that the demo writes",
               {"train.ply", "test.ply", "report/index.html"})
      ->capture_default_str();
  verb->not_of_result(app.add_option("--only", a->only, "Run only this part of the demo"))
      ->check(CLI::IsMember({"site", "real"}));
  app.add_option("--sensor", a->sensor, "Sensor of the catalogue that scans the site")
      ->capture_default_str();
  app.add_option("--sub-rays", a->beam.sub_rays, "Number of sub-rays of beams that scan the site")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace underbrush::app
