#include "contest.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "machine.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/order.hpp"

namespace underbrush::bench {
namespace {

constexpr size_t kCall = trace::kBatchRays;  // rays

// Runs the passes whose instructions bench/gates.py counts.
__attribute__((noinline)) void counted_pass(const trace::World& world, const Rays& rays,
                                            std::vector<trace::Intersection>& met) {
  trace_all(world, rays, met);
}

}  // namespace

Rays::Rays(std::vector<Ray> rays) : firing(std::move(rays)) {
  const auto float_rays = std::make_unique<trace::FloatRays>();
  std::vector<uint32_t> order(kCall);
  for (size_t begin = 0; begin < firing.size(); begin += kCall) {
    const size_t n = std::min(kCall, firing.size() - begin);
    const std::span<const Ray> part(&firing[begin], n);
    const auto azimuth = [](const Ray& r) { return std::atan2(r.direction.y(), r.direction.x()); };
    float_rays->azimuth_low = float_rays->sin_elevation_low = 4;
    float_rays->azimuth_high = float_rays->sin_elevation_high = -4;
    for (size_t k = 0; k < n; ++k) {
      const double turned = azimuth(part[k]) - azimuth(part[0]);
      const float turn = float(std::remainder(turned, 2 * M_PI) / (M_PI / 2));
      const float up = float(part[k].direction.z());
      float_rays->azimuth[k] = turn;
      float_rays->sin_elevation[k] = up;
      float_rays->azimuth_low = std::min(float_rays->azimuth_low, turn);
      float_rays->azimuth_high = std::max(float_rays->azimuth_high, turn);
      float_rays->sin_elevation_low = std::min(float_rays->sin_elevation_low, up);
      float_rays->sin_elevation_high = std::max(float_rays->sin_elevation_high, up);
    }
    trace::order_by_direction(*float_rays, {order.data(), n});
    for (size_t k = 0; k < n; ++k) coherent.push_back(part[order[k]]);
  }
  for (size_t i = 0; i < firing.size(); ++i) keys.push_back(beam_key(1, 0, i));
}

void Contest::add(std::string name, std::function<void()> f) {
  names_.push_back(std::move(name));
  runs_.push_back(std::move(f));
}

Json Contest::rates(size_t rays, int rounds) const {
  std::vector<std::vector<double>> rate(runs_.size());
  for (int r = 0; r < rounds; ++r) {
    for (size_t k = 0; k < runs_.size(); ++k) {
      rate[k].push_back(double(rays) / seconds_of(runs_[k]));
    }
  }
  Json j;
  for (size_t k = 0; k < runs_.size(); ++k) j[names_[k]] = median(rate[k]);
  return j;
}

Json Contest::instructions(size_t rays) const {
  Json j;
  for (size_t k = 0; k < runs_.size(); ++k) {
    const InstructionCounter counter;
    runs_[k]();
    if (const auto n = counter.count()) j[names_[k]] = *n / double(rays);
  }
  return j;
}

void print_machine(const Json& machine) {
  std::printf("%s, %d cores, %.2f GHz as measured\n",
              machine["processor"].get<std::string>().c_str(), machine["cores"].get<int>(),
              machine["clock_ghz"].get<double>());
  if (!InstructionCounter().count()) {
    std::printf("no counter of instructions on this machine; `make gates` counts them\n");
  }
}

double fastest(const Json& rates, const char* prefix) {
  double most = 0;
  for (const auto& [name, rate] : rates.items()) {
    if (name.starts_with(prefix)) most = std::max(most, rate.get<double>());
  }
  return most;
}

std::vector<trace::Isa> instruction_sets() {
  std::vector<trace::Isa> sets;
  for (trace::Isa isa : {trace::Isa::kBase, trace::Isa::kAvx2, trace::Isa::kAvx512}) {
    try {
      const elements::Model nothing;
      trace::World world(nothing, isa);
      sets.push_back(isa);
      // The instruction set is not available on this machine.
    } catch (const std::invalid_argument&) {
    }
  }
  return sets;
}

void trace_all(const trace::World& world, const Rays& rays, std::vector<trace::Intersection>& met) {
  parallel_for(rays.firing.size(), kCall, [&](size_t begin, size_t end) {
    const size_t n = end - begin;
    world.nearest_accepted({&rays.firing[begin], n}, {&rays.keys[begin], n}, {0, kMaxRange},
                           {&met[begin], n});
  });
}

int trace_passes(int passes, const elements::Model& model, std::vector<Ray> to_trace,
                 const std::string& isa) {
  set_threads(1);
  const trace::Isa with = isa == "avx512" ? trace::Isa::kAvx512
                          : isa == "avx2" ? trace::Isa::kAvx2
                                          : trace::Isa::kBase;
  std::optional<trace::World> built;
  const double build_s = seconds_of([&] { built.emplace(model, with); });
  std::printf("%zu elements, built in %.3f us each, %.1f bytes each\n", model.size(),
              1e6 * build_s / double(model.size()), double(built->bytes()) / double(model.size()));
  const Rays rays(std::move(to_trace));
  std::vector<trace::Intersection> met(rays.firing.size());
  for (int k = 0; k < passes; ++k) {
    const double s = seconds_of([&] { counted_pass(*built, rays, met); });
    std::printf("%zu rays, %.2f M rays/s\n", met.size(), 1e-6 * double(met.size()) / s);
  }
  return 0;
}

}  // namespace underbrush::bench
