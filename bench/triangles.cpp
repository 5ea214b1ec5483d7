// Traced beams per second in worlds of opaque triangles, against Embree's closest hit on the same
// triangles with the same rays in the same run. Rays come in firing order; our times include
// ordering them and putting the answers back, and Embree's rays are ordered before. The worlds are
// synthetic.
#include <cstdio>
#include <fstream>
#include <memory>

#include "command_line.hpp"
#include "contest.hpp"
#include "curves.hpp"
#include "embree.hpp"
#include "machine.hpp"
#include "programs.hpp"
#include "trace_scenes.hpp"
#include "triangle_scenes.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::bench {
namespace {

constexpr const char* kSensor = "velodyne-hdl64e";

elements::TriangleMesh all_triangles(const elements::Model& model) {
  elements::TriangleMesh mesh = model.ground;
  const uint32_t first = uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), model.surface.vertices.begin(),
                       model.surface.vertices.end());
  for (const auto& [a, b, c] : model.surface.triangles) {
    mesh.triangles.push_back({a + first, b + first, c + first});
  }
  return mesh;
}

/// Embree's high quality takes many times its tree's memory while it builds, so larger worlds are
/// without it.
constexpr size_t kMostOfHighQuality = 5000000;

/// Embree with one way of building and one instruction set, and how it takes rays.
struct Rival {
  const char* name;
  const char* config;
  RTCBuildQuality quality;
};

Json measure(const std::string& name, const elements::Model& model, int rounds) {
  const Rays rays(drive(kSensor, 2, 1));
  const size_t n = rays.firing.size();
  std::vector<float> range(n);
  std::vector<trace::Intersection> met(n);
  Contest contest;
  Json j;
  j["world"] = name;
  j["triangles"] = model.size();
  j["rays"] = n;
  set_threads(1);
  const elements::TriangleMesh mesh = all_triangles(model);
  std::vector<std::unique_ptr<Embree>> rivals;
  for (const Rival& r : {Rival{"embree", "threads=1", RTC_BUILD_QUALITY_MEDIUM},
                         Rival{"embree_high", "threads=1", RTC_BUILD_QUALITY_HIGH},
                         Rival{"embree_avx2", "threads=1,isa=avx2", RTC_BUILD_QUALITY_MEDIUM},
                         Rival{"embree_high_avx2", "threads=1,isa=avx2", RTC_BUILD_QUALITY_HIGH}}) {
    if (r.quality == RTC_BUILD_QUALITY_HIGH && model.size() > kMostOfHighQuality) continue;
    const std::string of(r.name);
    const double s =
        seconds_of([&] { rivals.push_back(std::make_unique<Embree>(mesh, r.config, r.quality)); });
    const Embree& e = *rivals.back();
    j["build_us_per_triangle"][of] = 1e6 * s / double(model.size());
    j["bytes_per_triangle"][of] = double(e.bytes()) / double(model.size());
    for (const auto& [mode, suffix] : {std::pair{EmbreeMode::kSingle, "_single"},
                                       {EmbreeMode::kPacket8, "_packet8"},
                                       {EmbreeMode::kPacket16, "_packet16"}}) {
      contest.add(of + suffix, [&e, &rays, &range, mode = mode] {
        e.closest_hits(rays.coherent, mode, float(kMaxRange), range);
      });
    }
  }
  std::vector<trace::World> worlds;
  worlds.reserve(3);
  for (trace::Isa isa : instruction_sets()) {
    const double s = seconds_of([&] { worlds.emplace_back(model, isa); });
    const trace::World& w = worlds.back();
    j["build_us_per_triangle"]["ours"] = 1e6 * s / double(model.size());
    j["bytes_per_triangle"]["ours"] = double(w.bytes()) / double(model.size());
    contest.add("ours_" + std::string(w.isa()), [&] { trace_all(w, rays, met); });
  }
  const Json rates = j["rays_per_s_per_core"] = contest.rates(n, rounds);
  j["instructions_per_ray"] = contest.instructions(n);
  size_t hits = 0;
  for (const trace::Intersection& m : met) hits += !m.none();
  j["hit_share"] = double(hits) / double(n);
  j["ratio_to_embree_best"] = fastest(rates, "ours") / fastest(rates, "embree");
  if (rates.contains("ours_avx2")) {
    const double avx2 = std::max(fastest(rates, "embree_avx2"), fastest(rates, "embree_high_avx2"));
    j["ratio_to_embree_best_avx2"] = rates["ours_avx2"].get<double>() / avx2;
  }
  set_threads(0);
  return j;
}

void print_rivals(const Json& j) {
  std::printf("%s, %zu triangles, %zu rays, %.0f %% hits\n", j["world"].get<std::string>().c_str(),
              j["triangles"].get<size_t>(), j["rays"].get<size_t>(),
              100 * j["hit_share"].get<double>());
  for (const auto& [name, rate] : j["rays_per_s_per_core"].items()) {
    std::printf("  %-26s %6.2f M rays/s a core\n", name.c_str(), 1e-6 * rate.get<double>());
  }
  for (const auto& [name, us] : j["build_us_per_triangle"].items()) {
    std::printf("  %-26s %6.2f us and %.0f bytes a triangle\n", name.c_str(), us.get<double>(),
                j["bytes_per_triangle"][name].get<double>());
  }
  for (const char* ratio : {"ratio_to_embree_best", "ratio_to_embree_best_avx2"}) {
    if (j.contains(ratio)) std::printf("  %-26s %6.2f\n", ratio, j[ratio].get<double>());
  }
  std::fflush(stdout);
}

}  // namespace

int bench_triangles(int argc, char** argv) {
  CommandLine line("Speed of the tracing engine in worlds of triangles, against Embree");
  std::string plot_file, isa = "avx2";
  std::vector<std::string> worlds(std::begin(kTriangleWorlds), std::end(kTriangleWorlds));
  std::vector<size_t> sizes{10000, 100000, 1000000, 10000000};
  int rounds = 5, passes = 0;
  line.add_json();
  line.add("--plot", &plot_file,
           "Draw rays/s against the number of triangles of the first world (SVG)");
  line.add("--rounds", &rounds, "Number of rounds in turns, of which the median counts");
  line.add("--worlds", &worlds, "Worlds to trace", worlds);
  line.add("--triangles", &sizes, "Numbers of their triangles");
  line.add("--passes", &passes, "Only trace the first world this many times, for profilers");
  line.add("--isa", &isa, "Instruction set of these passes", {"sse2", "avx2", "avx512"});
  if (const auto end = line.parse(argc, argv)) return *end;
  if (passes > 0) {
    return trace_passes(passes, triangle_world(worlds[0], sizes[0]), drive(kSensor, 1, 1), isa);
  }
  const Json on = machine();
  print_machine(on);
  Json cases = Json::array();
  for (const std::string& world : worlds) {
    for (const size_t n : sizes) {
      cases.push_back(measure(world, triangle_world(world, n), rounds));
      print_rivals(cases.back());
    }
  }
  if (!plot_file.empty()) {
    plot_curves(cases, "world", worlds[0], "triangles", "Triangles, " + worlds[0], plot_file);
  }
  line.write(Json{{"machine", on}, {"cases", cases}});
  return 0;
}

}  // namespace underbrush::bench
