// Fitting speed of each method: whole fits as multiples of a real sensor's rate, at a quarter, half
// and all of the log, with the exponent e of growth from a quarter to all, time ∝ beams^e. The
// clusterings are also timed alone, on the points of the log's tiles that are not ground. The log
// is the one given, else a scanned generated site.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "programs.hpp"
#include "site.hpp"
#include "timing.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::bench {
namespace {

/// Returns the least time of some runs, by the clock or, on a busy machine, as processor time over
/// threads.
template <class F>
double least_seconds(int runs, bool processor, int used_threads, F f) {
  double least = INFINITY;
  for (int k = 0; k < runs; ++k) {
    const std::clock_t start = std::clock();
    const double clock_s = seconds_of(f);
    const double processor_s = double(std::clock() - start) / CLOCKS_PER_SEC / used_threads;
    least = std::min(least, processor ? processor_s : clock_s);
  }
  return least;
}

/// Returns the points of a tile that are not ground.
struct Tile {
  std::vector<Vec3f> point, to_sensor;
};

std::vector<Tile> tiles_of(const BeamLog& log) {
  TileStore store;
  const Vec3 origin = log.origin.at(0).array().round();
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.is_hit(i)) {
      store.add({(log.end_point(i) - origin).cast<float>(), -log.direction[i]});
    }
  }
  std::vector<Tile> out;
  for (const TileKey key : store.tiles()) {
    const auto loaded = store.load(key, 0);
    const std::vector<uint8_t> ground = ground::segment(loaded.point, {});
    Tile& tile = out.emplace_back();
    for (size_t i = 0; i < loaded.core; ++i) {
      if (ground[i]) continue;
      tile.point.push_back(loaded.point[i]);
      tile.to_sensor.push_back(loaded.to_sensor[i]);
    }
  }
  return out;
}

/// A fitter and its name in the results.
struct Method {
  const char* label;
  fit::FitOptions options;
};

std::vector<Method> methods() {
  std::vector<Method> out;
  for (const char* name :
       {"voxel", "top_down", "bottom_up", "hierarchical", "likelihood", "surface", "rimls"}) {
    out.push_back({name, {}});
    out.back().options.fitter = name;
  }
  return out;
}

/// Times the clustering of all tiles on one thread; `voxel_s` is the time of the first method,
/// which is that of the voxels.
void time_clustering(const Method& m, const std::vector<Tile>& tiles, size_t points, int runs,
                     bool processor, double& voxel_s, nlohmann::ordered_json& j) {
  const double s = least_seconds(runs, processor, 1, [&] {
    for (const Tile& t : tiles) {
      cluster::volumes(m.options.fitter, {t.point, t.to_sensor}, m.options.volumetric, 1);
    }
  });
  if (voxel_s == 0) voxel_s = s;
  j["clustering_points_per_s_one_thread"] = double(points) / s;
  j["clustering_time_of_voxel"] = s / voxel_s;
  std::printf(" %7.2f Mp/s %8.2f", double(points) / s / 1e6, s / voxel_s);
}

}  // namespace

int bench_fitters(int argc, char** argv) {
  CommandLine line("Fitting speed of each method");
  std::string log_file;
  int runs = 3;
  bool quick = false, processor = false;
  line.add("LOG", &log_file, "A log (ray cloud PLY); default: a generated site, scanned");
  line.add_json();
  line.add("--runs", &runs, "Number of runs, of which the fastest counts");
  line.add("--quick", &quick, "Measure a small case");
  line.add("--processor-time", &processor,
           "Measure processor time over threads instead of the clock's time");
  if (const auto end = line.parse(argc, argv)) return *end;

  const BeamLog log = log_file.empty() ? scanned_site(quick ? 0.5 : 4) : io::read_log(log_file);
  if (quick) runs = 1;
  const std::vector<Tile> tiles = tiles_of(log);
  size_t points = 0;
  for (const Tile& t : tiles) points += t.point.size();
  std::printf("%zu beams, %zu points not ground, %d threads\n", log.size(), points, threads());
  std::printf("%-28s %9s %9s %9s %8s %8s %9s %12s %8s\n", "fit, M beams/s", "1/4", "1/2", "all",
              "growth", "x HDL64E", "elements", "clustering", "x voxel");
  nlohmann::ordered_json results;
  double voxel_s = 0;
  for (const Method& m : methods()) {
    nlohmann::ordered_json& j = results[m.label];
    std::printf("%-28s", m.label);
    double rate = 0, quarter_s = 0, growth = 0;
    size_t elements = 0;
    for (const int part : {4, 2, 1}) {
      BeamLog some = log.like();
      some.append(log, 0, log.size() / size_t(part));
      const double s = least_seconds(runs, processor, threads(), [&] {
        MemorySource source(some);
        const elements::Model model = pipeline::fit_model({source}, m.options).model;
        elements = model.ellipsoids.size() + model.surface.size();
      });
      if (part == 4) quarter_s = s;
      growth = std::log(s / quarter_s) / std::log(4.0 / part);
      rate = double(some.size()) / s;
      j["fit_beams_per_s_of_1_" + std::to_string(part)] = rate;
      std::printf(" %9.3f", rate / 1e6);
      std::fflush(stdout);
    }
    j["hdl64e_realtime_multiple"] = rate / kHdl64eBeamsPerS;
    j["growth_exponent"] = growth;
    j["elements"] = elements;
    std::printf(" %8.2f %8.2f %9zu", growth, rate / kHdl64eBeamsPerS, elements);
    if (cluster::clustering_named(m.options.fitter))
      time_clustering(m, tiles, points, runs, processor, voxel_s, j);
    std::printf("\n");
  }
  line.write(results);
  return 0;
}

}  // namespace underbrush::bench
