// Cost of the waveform stage per beam on one thread: signals of 41 sub-rays, their superposition,
// noise, detection, report. An OS1-64 fires 655 360 or 1 310 720 beams/s, which leaves 1526 or 763
// ns a beam on one core.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "programs.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::bench {
namespace {

/// Ranges of the sub-rays of many beams, and their reflection factors.
struct Returns {
  std::vector<float> range, weight, factor;
};

/// The `kind` of target is 0: a smooth surface, 1: an edge, 2: leaves over 2 m, 3: leaves over 20 m
/// with some sub-rays lost.
Returns returns_of(int kind, int beams, int sub_rays) {
  Stream random(uint64_t(7 + kind));
  Returns r;
  for (int b = 0; b < beams; ++b) {
    const double near = random.uniform(5, 80);
    for (int k = 0; k < sub_rays; ++k) {
      double range = near + 0.02 * random.uniform();
      if (kind == 1 && k > sub_rays / 2) range += 3;
      if (kind == 2) range += 2 * random.uniform();
      if (kind == 3) range += 20 * random.uniform();
      if (kind == 3 && random.uniform() < 0.2) range = INFINITY;
      r.range.push_back(float(range));
      r.weight.push_back(1.0f / float(sub_rays));
      r.factor.push_back(float(random.uniform(0.1, 0.6)));
    }
  }
  return r;
}

/// Returns the CPU time of this thread, since others may share the machine.
double now_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

template <class F>
double ns_per_beam(int beams, int runs, F f) {
  double best = INFINITY;
  for (int k = 0; k < runs; ++k) {
    const double start = now_s();
    for (int b = 0; b < beams; ++b) f(b);
    best = std::min(best, (now_s() - start) * 1e9 / beams);
  }
  return best;
}

/// Receives beams; bench/gates.py counts the instructions.
__attribute__((noinline)) double counted_pass(const radiometry::Receiver& receiver,
                                              const Returns& r, int beams, size_t n) {
  radiometry::Waveform scratch = receiver.scratch();
  std::vector<float> signal(n);
  double echoes = 0;
  for (int b = 0; b < beams; ++b) {
    const auto at = [&](const std::vector<float>& v) {
      return std::span<const float>(v).subspan(size_t(b) * n, n);
    };
    echoes +=
        receiver.receive(at(r.range), at(r.weight), at(r.factor), signal, uint64_t(b), scratch)
            .count;
  }
  return echoes;
}

// What the sub-rays of a beam meet.
const std::vector<std::string> kKinds{"surface", "edge", "leaves_2m", "leaves_20m"};

}  // namespace

// long: a list of options and one table of figures.
int bench_waveform(int argc, char** argv) {
  CommandLine line("Waveform and detection, ns per beam on one thread");
  int sub_rays = 41, beams = 2000, runs = 50;
  std::string pass, sensor_name = "ouster-os1-64";
  line.add("--sub-rays", &sub_rays, "Sub-rays of each beam");
  line.add("--sensor", &sensor_name, "Sensor whose receiver is used");
  line.add("--runs", &runs, "Number of runs, of which the fastest counts");
  line.add_json();
  line.add("--pass", &pass, "Only receive beams of this kind once, to count instructions", kKinds);
  if (const auto end = line.parse(argc, argv)) return *end;

  radiometry::ReceiverOptions options =
      radiometry::receiver_options(sensor::load(sensor_name), 1e-4);
  options.adc_step = 0.5f;
  options.mode = radiometry::ReturnMode::kAll;
  options.max_echoes = 3;
  const radiometry::Receiver receiver(options);
  radiometry::Waveform scratch = receiver.scratch();
  const size_t n = size_t(sub_rays);
  if (!pass.empty()) {
    const auto kind = int(std::find(kKinds.begin(), kKinds.end(), pass) - kKinds.begin());
    const double found = counted_pass(receiver, returns_of(kind, beams, sub_rays), beams, n);
    std::printf("%d beams, %.0f echoes\n", beams, found);
    return 0;
  }
  std::vector<float> signal(n);
  nlohmann::ordered_json j;
  double echoes = 0, sum = 0;
  const sensor::Sensor sensor = sensor::load(sensor_name);
  const auto places = sensor::spread_sub_rays(sensor.beam, sub_rays);
  const sensor::RayMaker maker(sensor.beam);
  j["sub_rays_ns"] = ns_per_beam(beams, runs, [&](int b) {
    const sensor::BeamAxes axes = sensor::beam_axes({Vec3(b, 0, 0), Vec3(0.6, 0, 0.8)});
    for (const sensor::SubRay& p : places) {
      const Ray ray = maker.ray(axes, double(p.u), double(p.v));
      sum += ray.direction.sum() + ray.origin.sum();
    }
  });
  for (size_t kind = 0; kind < kKinds.size(); ++kind) {
    const Returns r = returns_of(int(kind), beams, sub_rays);
    const auto at = [&](const std::vector<float>& v, int b) {
      return std::span<const float>(v).subspan(size_t(b) * n, n);
    };
    const std::string& name = kKinds[kind];
    j[name + "_signals_ns"] = ns_per_beam(beams, runs, [&](int b) {
      receiver.signals(at(r.range, b), at(r.weight, b), at(r.factor, b), signal);
    });
    j[name + "_superposition_ns"] = ns_per_beam(beams, runs, [&](int b) {
      scratch.clear();
      scratch.add(at(r.range, b), at(r.factor, b));
    });
    j[name + "_all_ns"] = ns_per_beam(beams, runs, [&](int b) {
      echoes += receiver
                    .receive(at(r.range, b), at(r.weight, b), at(r.factor, b), signal,
                             beam_key(1, 0, uint64_t(b)), scratch)
                    .count;
    });
  }
  j["echoes_per_beam"] = echoes / (4.0 * beams * runs);
  j["check"] = sum;  // Printing the sum keeps the compiler from leaving the work out.
  j["taps"] = receiver.response().taps();
  for (const auto& [key, value] : j.items())
    std::printf("%-32s %s\n", key.c_str(), value.dump().c_str());
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
