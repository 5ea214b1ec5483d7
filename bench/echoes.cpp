// Speed of the whole instrument: sub-rays, tracing, light, waveforms, echoes, rows of the log. An
// OS1-64 on a vehicle scans a forest of 100 000 ellipsoids on 100 000 triangles, with 41 sub-rays a
// beam. Reports the beams per second beside those that the sensor fires (1024 columns at 10 Hz, and
// at 20 Hz); misses count as beams. The scene is synthetic.
#include "underbrush/simulate/echoes.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "programs.hpp"
#include "run.hpp"
#include "timing.hpp"
#include "trace_scenes.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::bench {
namespace {

elements::Model forest_on_ground(size_t ellipsoids, size_t triangles) {
  elements::Model model = forest(ellipsoids);
  const double side = 100;
  model.ground = ground_mesh(side, side / std::floor(std::sqrt(double(triangles) / 2)));
  return model;
}

/// Time of the parts of the work over all threads, and the result.
struct Measured {
  double seconds = 0, cpu_s = 0;
  size_t beams = 0, hits = 0, echoes = 0;
};

Measured answer(simulate::EchoMaker& maker, const std::vector<BeamLog>& fired) {
  Measured m;
  for (const BeamLog& chunk : fired) {
    BeamLog beams = chunk;
    const double cpu = cpu_seconds();
    m.seconds += seconds_of([&] { maker.answer(m.beams, beams); });
    m.cpu_s += cpu_seconds() - cpu;
    m.beams += chunk.size();
    const auto& echo = std::get<std::vector<uint8_t>>(beams.extra.at(kEchoColumn));
    for (const uint8_t e : echo) m.hits += e == 1, m.echoes += e > 0;
  }
  return m;
}

/// How the first echoes of two makers differ: the share of beams with an echo of one alone, and of
/// those with two echoes the mean absolute difference of range and the share beyond 5 cm.
struct Difference {
  size_t beams = 0, one_alone = 0, both = 0, far = 0;
  double sum_m = 0;
};

Difference difference(simulate::EchoMaker& a, simulate::EchoMaker& b,
                      const std::vector<BeamLog>& fired) {
  Difference d;
  for (const BeamLog& chunk : fired) {
    BeamLog x = chunk, y = chunk;
    a.answer(d.beams, x);
    b.answer(d.beams, y);
    keep_first_echoes(x);
    keep_first_echoes(y);
    for (size_t i = 0; i < x.size(); ++i) {
      if (!x.is_hit(i) || !y.is_hit(i)) {
        d.one_alone += x.is_hit(i) != y.is_hit(i);
        continue;
      }
      const double off = std::abs(double(x.range_m[i]) - double(y.range_m[i]));
      ++d.both;
      d.sum_m += off;
      d.far += off > 0.05;
    }
    d.beams += x.size();
  }
  return d;
}

nlohmann::ordered_json json_of(const Difference& d) {
  return {{"one_alone", double(d.one_alone) / double(d.beams)},
          {"mean_m", d.sum_m / double(d.both)},
          {"beyond_5_cm", double(d.far) / double(d.both)}};
}

/// The beams of a drive of so many seconds, in chunks.
std::vector<BeamLog> fired_beams(const sensor::Sensor& sensor, double seconds) {
  const Trajectory path({{0, {{1, 0, 0, 0}, {-20, 0, 2}}}, {4, {{1, 0, 0, 0}, {20, 0, 2}}}});
  sensor::PatternSource source(sensor, path, 1, 1 + seconds, 1 << 16);
  std::vector<BeamLog> fired;
  for (BeamLog chunk; source.next(chunk);) fired.push_back(chunk);
  return fired;
}

/// The sensor's beam and receiver.
simulate::Instrument instrument_of(const sensor::Sensor& sensor, int sub_rays,
                                   const std::string& returns) {
  simulate::Instrument instrument;
  instrument.beam = sensor.beam;
  instrument.sub_rays = sensor::spread_sub_rays(sensor.beam, sub_rays);
  instrument.receiver = radiometry::receiver_options(sensor, 1e-4);
  if (returns == "all") {
    instrument.receiver.mode = radiometry::ReturnMode::kAll;
    instrument.receiver.max_echoes = 3;
  }
  return instrument;
}

/// Answers a chunk of beams; bench/gates.py counts the instructions.
__attribute__((noinline)) void counted_pass(simulate::EchoMaker& maker, BeamLog& beams) {
  maker.answer(0, beams);
}

/// Prints the figures.
void report(const nlohmann::ordered_json& j) {
  for (const auto& [key, value] : j.items()) {
    std::printf("%-26s %s\n", key.c_str(), value.dump().c_str());
  }
}

}  // namespace

// long: a list of options and one table of figures.
int bench_echoes(int argc, char** argv) {
  CommandLine line("Beams a second of the whole instrument");
  int sub_rays = 41, threads = 0, rounds = 5, passes = 0;
  size_t ellipsoids = 100000, triangles = 100000;
  double seconds = 0.4;
  std::string returns = "strongest";
  line.add("--sub-rays", &sub_rays, "Sub-rays of each beam");
  line.add("--ellipsoids", &ellipsoids, "Number of ellipsoids");
  line.add("--triangles", &triangles, "Number of triangles of the ground");
  line.add("--threads", &threads, "Number of threads; 0 = all cores");
  line.add("--rounds", &rounds, "Number of rounds, of which the median counts");
  line.add("--seconds", &seconds, "Length of the drive, s");
  line.add("--returns", &returns, "strongest, or all (up to 3)");
  line.add("--passes", &passes,
           "Only answer the first 65 536 beams so often with one thread, to count "
           "instructions");
  line.add_json();
  if (const auto end = line.parse(argc, argv)) return *end;
  set_threads(passes > 0 ? 1 : threads);

  const elements::Model model = forest_on_ground(ellipsoids, triangles);
  const trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  const trace::World world_anew(model);
  const simulate::DynamicWorld once(world), anew(world_anew);
  const sensor::Sensor sensor = sensor::load("ouster-os1-64");
  const std::vector<BeamLog> fired = fired_beams(sensor, seconds);
  const simulate::Instrument instrument = instrument_of(sensor, sub_rays, returns);
  const simulate::Reflection reflection(radiometry::load_materials(), sensor.wavelength_m);
  simulate::Instrument thin = instrument;
  thin.sub_rays = {{}};
  simulate::EchoOptions all;
  all.all_sub_rays = true;
  simulate::EchoMaker maker(once, reflection, instrument, {});
  for (int k = 0; k < passes; ++k) {
    BeamLog beams = fired[0];
    counted_pass(maker, beams);
    std::printf("%zu beams\n", fired[0].size());
  }
  if (passes > 0) return 0;
  simulate::EchoMaker all_maker(once, reflection, instrument, all);
  simulate::EchoMaker anew_maker(anew, reflection, instrument, {});
  simulate::EchoMaker thin_maker(once, reflection, thin, {});

  std::vector<double> rate, all_rate, anew_rate, thin_rate, cpu_ns;
  Measured m;
  answer(maker, {fired[0]});  // A first run to warm up.
  const size_t warm = maker.rays();
  const auto rate_of = [&](simulate::EchoMaker& other) {
    const Measured one = answer(other, fired);
    return double(one.beams) / one.seconds;
  };
  for (int r = 0; r < rounds; ++r) {
    m = answer(maker, fired);
    rate.push_back(double(m.beams) / m.seconds);
    cpu_ns.push_back(1e9 * m.cpu_s / double(m.beams));
    all_rate.push_back(rate_of(all_maker));
    anew_rate.push_back(rate_of(anew_maker));
    thin_rate.push_back(rate_of(thin_maker));
  }
  const double traced = double(maker.rays() - warm) / double(rounds) / double(m.beams);
  nlohmann::ordered_json j;
  j["ellipsoids"] = model.ellipsoids.size();
  j["triangles"] = model.ground.size();
  j["sub_rays"] = sub_rays;
  j["threads"] = underbrush::threads();
  j["isa"] = world.isa();
  j["beams"] = m.beams;
  j["hits"] = m.hits;
  j["echoes"] = m.echoes;
  j["beams_per_s"] = median(rate);
  j["sub_rays_traced"] = traced;
  j["cpu_ns_per_beam"] = median(cpu_ns);
  j["least_cpu_ns_per_beam"] = *std::min_element(cpu_ns.begin(), cpu_ns.end());
  j["times_os1_10hz"] = median(rate) / sensor.beams_per_s();
  j["times_os1_20hz"] = median(rate) / kOs1BeamsPerS;
  j["all_sub_rays_beams_per_s"] = median(all_rate);
  j["all_sub_rays_anew_beams_per_s"] = median(anew_rate);
  j["one_sub_ray_beams_per_s"] = median(thin_rate);
  j["unlike_all"] = json_of(difference(maker, all_maker, fired));
  report(j);
  line.write(j);
  return 0;
}

}  // namespace underbrush::bench
