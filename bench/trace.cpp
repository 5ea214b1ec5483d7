// Traced beams per second against the number of elements, sub-rays a beam and kind of scene. The
// reference is Embree's closest hit on as many triangles with the same rays in the same run. Rays
// come in firing order; our times include ordering them and putting the answers back, Embree's do
// not. The scenes are synthetic.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "command_line.hpp"
#include "contest.hpp"
#include "curves.hpp"
#include "embree.hpp"
#include "machine.hpp"
#include "programs.hpp"
#include "trace_scenes.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::bench {
namespace {

/// Larger scenes of instances have one Embree and not two: it takes about half a kilobyte each.
constexpr size_t kMostInstancesTwice = 5000000;

struct Case {
  const char* scene;
  size_t elements;
  int sub_rays;
};

class Bench {
 public:
  Bench(int rounds, bool quick) : rounds_(rounds), quick_(quick) {}

  Json model_case(const Case& c, const elements::Model& model, const char* sensor) {
    const Rays rays(drive(sensor, quick_ ? 1 : c.sub_rays > 1 ? 1 : 4, c.sub_rays));
    const elements::TriangleMesh triangles = as_triangles(model);
    const Embree best(triangles), avx2(triangles, "isa=avx2");
    Contest contest;
    std::vector<float> range(rays.firing.size());
    add_embree(contest, "embree", best, rays, range);
    add_embree(contest, "embree_avx2", avx2, rays, range);
    return finish(
        c, contest, rays, [&](trace::Isa isa) { return trace::World(model, isa); }, model.size());
  }

  Json scene_case(const Case& c, const elements::Scene& scene, const char* sensor) {
    const Rays rays(drive(sensor, quick_ ? 1 : c.sub_rays > 1 ? 1 : 4, c.sub_rays));
    std::vector<elements::TriangleMesh> triangles;
    for (const elements::Model& m : scene.models) triangles.push_back(as_triangles(m));
    Contest contest;
    std::vector<float> range(rays.firing.size());
    const Embree best(triangles, scene.instances);
    add_embree(contest, "embree", best, rays, range);
    std::optional<Embree> avx2;
    if (scene.instances.size() <= kMostInstancesTwice) {
      avx2.emplace(triangles, scene.instances, "isa=avx2");
      add_embree(contest, "embree_avx2", *avx2, rays, range);
    }
    Json j = finish(
        c, contest, rays, [&](trace::Isa isa) { return trace::World(scene, isa); }, 0);
    j["bytes_per_instance_embree"] = double(best.bytes()) / double(scene.instances.size());
    size_t of_models = 0, virtually = 0;
    for (const auto& i : scene.instances) virtually += scene.models[i.model].ellipsoids.size();
    for (const auto& m : scene.models) of_models += trace::World(m).bytes();
    const size_t whole = trace::World(scene).bytes();
    j["ellipsoids_placed"] = virtually;
    j["bytes_per_instance"] =
        double(whole - of_models) / double(scene.instances.size()) + sizeof(elements::Instance);
    return j;
  }

 private:
  static void add_embree(Contest& contest, const std::string& name, const Embree& e,
                         const Rays& rays, std::vector<float>& range) {
    const auto add = [&](const char* suffix, const std::vector<Ray>& r, EmbreeMode mode) {
      contest.add(name + suffix,
                  [&e, &r, &range, mode] { e.closest_hits(r, mode, float(kMaxRange), range); });
    };
    add("_single", rays.firing, EmbreeMode::kSingle);
    add("_packet8", rays.coherent, EmbreeMode::kPacket8);
    add("_packet16", rays.coherent, EmbreeMode::kPacket16);
  }

  template <class MakeWorld>
  Json finish(const Case& c, Contest& contest, const Rays& rays, MakeWorld make,
              size_t elements) const {
    std::vector<trace::Intersection> met(rays.firing.size());
    std::vector<trace::World> worlds;
    set_threads(1);
    std::vector<double> builds;
    for (trace::Isa isa : isas_) {
      builds.push_back(seconds_of([&] { worlds.push_back(make(isa)); }));
    }
    const double build_s = median(builds);
    for (const trace::World& w : worlds) {
      contest.add("ours_" + std::string(w.isa()), [&] { trace_all(w, rays, met); });
    }
    Json j;
    j["scene"] = c.scene;
    j["elements"] = c.elements;
    j["sub_rays"] = c.sub_rays;
    j["rays"] = rays.firing.size();
    j["rays_per_s_per_core"] = contest.rates(rays.firing.size(), rounds_);
    j["instructions_per_ray"] = contest.instructions(rays.firing.size());
    set_threads(2);
    Contest two;
    for (const trace::World& w : worlds) {
      two.add("ours_" + std::string(w.isa()), [&] { trace_all(w, rays, met); });
    }
    j["rays_per_s_2_cores"] = two.rates(rays.firing.size(), rounds_);
    set_threads(0);
    if (elements > 0) {
      j["build_us_per_element_1_thread"] = 1e6 * build_s / double(elements);
      j["bytes_per_element"] = double(worlds.back().bytes()) / double(elements);
    } else {
      j["build_s_1_thread"] = build_s;
    }
    size_t hits = 0;
    for (const trace::Intersection& m : met) hits += !m.none();
    j["hit_share"] = double(hits) / double(met.size());
    return j;
  }

  int rounds_;
  bool quick_;
  std::vector<trace::Isa> isas_ = instruction_sets();
};

void print(const Json& j) {
  std::printf("%-8s %9zu elements %3d sub-rays:", j["scene"].get<std::string>().c_str(),
              j["elements"].get<size_t>(), j["sub_rays"].get<int>());
  for (const auto& [name, rate] : j["rays_per_s_per_core"].items()) {
    std::printf(" %s %.2f", name.c_str(), 1e-6 * rate.get<double>());
  }
  std::printf(" M rays/s a core; 2 cores %.2f", 1e-6 * fastest(j["rays_per_s_2_cores"], "ours"));
  for (const char* key : {"build_us_per_element_1_thread", "bytes_per_element", "build_s_1_thread",
                          "bytes_per_instance"}) {
    if (j.contains(key) && j[key].is_number()) std::printf("; %s %.3g", key, j[key].get<double>());
  }
  for (const auto& [name, count] : j["instructions_per_ray"].items()) {
    const double rate = j["rays_per_s_per_core"][name].get<double>();
    std::printf("; %s %.0f instructions a ray, %.2f G/s", name.c_str(), count.get<double>(),
                1e-9 * rate * count.get<double>());
  }
  std::printf("\n");
  std::fflush(stdout);
}

double rate_of(const Json& j, const char* name) {
  const Json& rates = j["rays_per_s_per_core"];
  return rates.contains(name) ? rates[name].get<double>() : 0;
}

const Json* find(const Json& cases, const char* scene, size_t elements, int sub_rays) {
  for (const Json& j : cases) {
    if (j["scene"] == scene && j["elements"] == elements && j["sub_rays"] == sub_rays) return &j;
  }
  return nullptr;
}

/// Returns the figures that goals are set for, in the dense forest of 10⁶ ellipsoids (10⁵ when
/// quick).
Json summary(const Json& cases, size_t middle) {
  const Json &one = *find(cases, "forest", middle, 1), &sub = *find(cases, "forest", middle, 16);
  const Json &core = one["rays_per_s_per_core"], &two = one["rays_per_s_2_cores"];
  Json j;
  j["hdl64e_realtime_multiple_1e6"] = fastest(two, "ours") / kHdl64eBeamsPerS;
  j["os1_64_realtime_multiple_1e6"] = fastest(two, "ours") / kOs1BeamsPerS;
  j["ratio_to_embree_best_1e6"] = fastest(core, "ours") / fastest(core, "embree");
  if (const double avx2 = rate_of(one, "ours_avx2"); avx2 > 0) {
    j["avx2_beams_per_s_per_core_1e6"] = avx2;
    j["hdl64e_realtime_multiple_avx2_1e6"] = two["ours_avx2"].get<double>() / kHdl64eBeamsPerS;
    j["ratio_to_embree_packets_avx2_1e6"] = avx2 / rate_of(one, "embree_avx2_packet8");
    for (const auto& [name, scene, elements] :
         {std::tuple{"avx2_beams_per_s_per_core_1e7", "forest", size_t(10000000)},
          std::tuple{"avx2_beams_per_s_per_core_1e6_instances", "planted", size_t(1000000)}}) {
      if (const Json* c = find(cases, scene, elements, 1)) j[name] = rate_of(*c, "ours_avx2");
    }
  }
  j["hdl64e_realtime_multiple_sub_rays_1e6"] =
      fastest(sub["rays_per_s_2_cores"], "ours") / sub["sub_rays"].get<double>() / kHdl64eBeamsPerS;
  double bytes = 0, build_us = 0;
  for (const Json& c : cases) {
    if (c["scene"] != "forest") continue;
    bytes = std::max(bytes, c["bytes_per_element"].get<double>());
    build_us = std::max(build_us, c["build_us_per_element_1_thread"].get<double>());
  }
  j["bytes_per_element"] = bytes;
  j["build_us_per_element_1_thread"] = build_us;
  return j;
}

/// Measures and prints all cases; those of one size have `middle` ellipsoids.
Json measure_all(Bench& bench, size_t middle, bool quick) {
  const char* hdl = "velodyne-hdl64e";
  Json cases = Json::array();
  const auto keep = [&](const Json& j) {
    print(j);
    cases.push_back(j);
  };
  const std::vector<size_t> sizes = quick ? std::vector<size_t>{10000, 100000}
                                          : std::vector<size_t>{10000, 100000, 1000000, 10000000};
  for (size_t n : sizes) {
    const auto model = forest(n);
    keep(bench.model_case({"forest", n, 1}, model, hdl));
    if (n != middle) continue;
    keep(bench.model_case({"forest_os1", n, 1}, model, "ouster-os1-64"));
    keep(bench.model_case({"forest", n, 9}, model, hdl));
    keep(bench.model_case({"forest", n, 16}, model, hdl));
    if (!quick) keep(bench.model_case({"forest", n, 41}, model, hdl));
  }
  keep(bench.model_case({"field", middle, 1}, field(middle), hdl));
  for (size_t n :
       quick ? std::vector<size_t>{1000} : std::vector<size_t>{10000, 100000, 1000000, 10000000}) {
    keep(bench.scene_case({"planted", n, 1}, planted(n), hdl));
  }
  return cases;
}

}  // namespace

int bench_trace(int argc, char** argv) {
  CommandLine line("Speed of the tracing engine against Embree and real sensors");
  std::string plot_file;
  int rounds = 5;
  int passes = 0, sub_rays = 1;
  size_t elements = 100000;
  std::string isa = "avx2";
  bool quick = false;
  line.add_json();
  line.add("--plot", &plot_file,
           "Draw rays/s against the number of ellipsoids (SVG), and against that of instances "
           "in a second file, NAME.instances.svg");
  line.add("--rounds", &rounds, "Number of rounds in turns, of which the median counts");
  line.add("--quick", &quick, "Measure fewer and smaller cases (10^5 stands for 10^6)");
  line.add("--passes", &passes, "Only trace one forest this many times, for profilers");
  line.add("--elements", &elements, "Number of ellipsoids of that forest");
  line.add("--sub-rays", &sub_rays, "Sub-rays of each beam in these passes");
  line.add("--isa", &isa, "Instruction set of these passes", {"sse2", "avx2", "avx512"});
  if (const auto end = line.parse(argc, argv)) return *end;
  if (passes > 0) {
    return trace_passes(passes, forest(elements), drive("velodyne-hdl64e", 1, sub_rays), isa);
  }
  if (quick) rounds = std::min(rounds, 3);

  const Json on = machine();
  print_machine(on);
  Bench bench(rounds, quick);
  const size_t middle = quick ? 100000 : 1000000;
  const Json cases = measure_all(bench, middle, quick);
  Json out = summary(cases, middle);
  for (const auto& [key, value] : out.items()) {
    std::printf("%-42s %.4g\n", key.c_str(), value.get<double>());
  }
  out["machine"] = on;
  out["cases"] = cases;
  if (!plot_file.empty()) {
    plot_curves(cases, "scene", "forest", "elements", "Dense forest", plot_file);
    const std::string second = std::filesystem::path(plot_file).replace_extension("instances.svg");
    plot_curves(cases, "scene", "planted", "elements", "Instances of trees", second);
  }
  line.write(out);
  return 0;
}

}  // namespace underbrush::bench
