#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "report/report.hpp"
#include "score_json.hpp"
#include "stages.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/test_site/test_site.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/footprint.hpp"
#include "cli/progress.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace fs = std::filesystem;

struct Arguments {
  std::string output = "demo", sensor = "velodyne-hdl32e";
  test_site::SiteParameters site;
  simulate::FootprintOptions beam;
};

constexpr const char* kSynthetic =
    "Synthetic data: a generated site of fine triangles, scanned by a beam with divergence, stands "
    "in "
    "for reality. Nothing here was measured.";

/// Replaces the column `element` by `instance`: the plant that was hit, 0 for ground and misses.
void add_instances(const test_site::FlatSite& flat, BeamLog& beams) {
  auto& element = std::get<std::vector<uint32_t>>(beams.extra.at("element"));
  for (uint32_t& e : element) e = e < flat.instance.size() ? flat.instance[e] : 0;
  beams.extra["instance"] = std::move(element);
  beams.extra.erase("element");
}

/// Scans the site along its drive; even scans go to `train`, odd ones to `test`. Returns the beams.
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

void run(const Verb& verb, Arguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto say = [&](const std::string& line) {
    if (verb.json == "-") return;
    std::cout << fmt::format("[{:5.1f} s] {}\n",
                             std::chrono::duration<double>(Clock::now() - start).count(), line)
              << std::flush;
  };
  const fs::path folder = a.output;
  fs::create_directories(folder);
  const fs::path train = folder / "train.ply", test = folder / "test.ply";
  a.site.seed = a.beam.seed = verb.seed;
  a.beam.element_ids = true;
  say(kSynthetic);
  const size_t beams = scan_site(verb, a, train, test);
  say(fmt::format("scanned the site with {}: {} beams; even scans train, odd scans are held out",
                  a.sensor, beams));

  std::vector<Candidate> candidates;
  for (const char* fitter : {"hierarchical", "surface"}) {
    fit::FitOptions options;
    options.fitter = fitter;
    options.seed = verb.seed;
    const fs::path model = folder / fitter, log = folder / (std::string(fitter) + ".ply");
    const FitStep fitted = fit_log(verb, train, options, model);
    io::LogReader like(test);
    simulate::Options simulate;
    simulate.seed = verb.seed;
    const SimulateStep simulated =
        simulate_log(verb, trace::World(fitted.result.model), like, simulate, log, {model, test});
    const elements::Model& m = fitted.result.model;
    say(fmt::format("{}: fitted {} ellipsoids, {} triangles ({:.1f} s), simulated {} beams", fitter,
                    m.ellipsoids.size(), m.ground.size() + m.surface.size(), fitted.seconds,
                    simulated.beams));
    candidates.push_back({fitter, log, model});
  }
  const std::vector<metrics::Score> scores = score_logs(test, candidates, true);
  std::vector<std::string> names;
  std::vector<fs::path> inputs{test};
  report::ReportInput report;
  for (const Candidate& c : candidates) {
    names.push_back(c.name);
    inputs.push_back(c.log);
    report.simulated.push_back({c.name, c.log});
  }
  Json results = json_of_scores(names, scores, provenance(verb, inputs));
  report.title = "Underbrush demo: a generated test site";
  report.note = kSynthetic;
  report.scores = results;
  report.real = test;
  const fs::path page = report::write_report(folder / "report", report);
  results["seconds"] = std::chrono::duration<double>(Clock::now() - start).count();
  results["synthetic"] = true;
  say("scored on the held-out scans");
  verb.report(results,
              table_of_scores(candidates, scores) + fmt::format("report: {}\n", page.string()));
}

}  // namespace

void add_demo(Program& program) {
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Start", "demo", "The whole pipeline on a generated test site; ends with a report",
               "underbrush demo -o demo/", [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  verb->output("-o,--output", a->output, "Folder for all that the demo makes")
      ->capture_default_str();
  app.add_option("--sensor", a->sensor, "Sensor of the catalogue that scans the site")
      ->capture_default_str();
  app.add_option("--sub-rays", a->beam.sub_rays, "Rays a beam when the site is scanned")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace underbrush::app
