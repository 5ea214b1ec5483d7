// Speed of fitting and simulation as multiples of a real sensor's rate, with Embree's closest hit
// on the same ground mesh and the same rays in the same run as the reference. The log is the one
// given, else a scanned generated site.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "embree.hpp"
#include "programs.hpp"
#include "site.hpp"
#include "timing.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulation.hpp"

namespace underbrush::bench {
namespace {

/// Returns the median rate (items/s) of several runs.
template <class F>
double median_rate(size_t items, int runs, F f) {
  std::vector<double> rates;
  rates.reserve(size_t(runs));
  for (int k = 0; k < runs; ++k) rates.push_back(double(items) / seconds_of(f));
  return median(rates);
}

/// The median rate of simulation in memory (beams/s), with keyframes or without them.
double simulation_rate(const pipeline::TracedWorld& world, const BeamLog& log, int runs,
                       bool keyframes) {
  pipeline::SimulateOptions options;
  options.keyframes = keyframes;
  pipeline::Simulation simulation(world, options);
  BeamLog answered = log;
  return median_rate(log.size(), runs, [&] { simulation.answer(0, answered); });
}

}  // namespace

int bench_pipeline(int argc, char** argv) {
  CommandLine line("Speed of fit and simulate against the sensor's rate and Embree");
  std::string log_file;
  int runs = 5;
  bool quick = false;
  line.add("LOG", &log_file, "A log (ray cloud PLY); default: a generated site, scanned");
  line.add_json();
  line.add("--runs", &runs, "Number of runs, of which the median counts");
  line.add("--quick", &quick, "Measure a small case");
  if (const auto end = line.parse(argc, argv)) return *end;

  const BeamLog log = log_file.empty() ? scanned_site(quick ? 0.5 : 4) : io::read_log(log_file);
  if (quick) runs = 1;
  pipeline::FittedModel fitted;
  const double fit_rate = median_rate(log.size(), runs, [&] {
    MemorySource source(log);
    fitted = pipeline::fit_model({source}, {});
  });
  const elements::Model& model = fitted.model;
  std::unique_ptr<pipeline::TracedWorld> world;
  const double build_s =
      seconds_of([&] { world = std::make_unique<pipeline::TracedWorld>(model); });
  const double simulate_rate = simulation_rate(*world, log, runs, true),
               bare_rate = simulation_rate(*world, log, runs, false);
  const Embree embree(model.ground);
  std::vector<Ray> rays;
  for (size_t i = 0; i < log.size(); ++i) {
    rays.push_back({log.origin[i] - model.origin, log.direction[i].cast<double>()});
  }
  std::vector<float> range(rays.size());
  const double embree_rate = median_rate(log.size(), runs, [&] {
    parallel_for(rays.size(), 4096, [&](size_t begin, size_t end) {
      const size_t n = end - begin;
      embree.closest_hits({&rays[begin], n}, EmbreeMode::kSingle, 120, {&range[begin], n});
    });
  });

  nlohmann::ordered_json j;
  j["beams"] = log.size();
  j["ellipsoids"] = model.ellipsoids.size();
  j["ground_triangles"] = model.ground.size();
  j["threads"] = threads();
  j["isa"] = world->still().isa();
  j["fit_beams_per_s"] = fit_rate;
  j["fit_hdl64e_realtime_multiple"] = fit_rate / kHdl64eBeamsPerS;
  j["world_build_s"] = build_s;
  j["simulate_beams_per_s"] = simulate_rate;
  j["simulate_hdl64e_realtime_multiple"] = simulate_rate / kHdl64eBeamsPerS;
  j["simulate_without_keyframes_beams_per_s"] = bare_rate;
  j["simulate_without_keyframes_hdl64e_realtime_multiple"] = bare_rate / kHdl64eBeamsPerS;
  j["embree_ground_closest_hit_rays_per_s"] = embree_rate;
  j["simulate_to_embree_ground_ratio"] = simulate_rate / embree_rate;
  for (const auto& [key, value] : j.items())
    std::printf("%-40s %s\n", key.c_str(), value.dump().c_str());
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
