#include <algorithm>
#include <cmath>

#include "underbrush/calibrate/grain.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "underbrush/simulate/echoes.hpp"

namespace underbrush::calibrate {
namespace {

constexpr size_t kSampledBeams = 20000;
constexpr int kSubRays = 25, kHalvings = 9;
constexpr double kLeastGrain = 0.001, kMostGrain = 0.5;  // m

/// Some beams of a log, and the mean number of echoes of those that have any.
struct Sample {
  BeamLog beams;
  double echoes = 0;
};

double ratio(size_t echoes, size_t beams) {
  return beams == 0 ? 0 : double(echoes) / double(beams);
}

double echoes_of(const BeamLog& log) {
  size_t echoes = 0, beams = 0;
  const std::vector<bool> first = begins_beam(log);
  for (size_t i = 0; i < log.size(); ++i) {
    echoes += log.is_hit(i);
    beams += log.is_hit(i) && first[i];
  }
  return ratio(echoes, beams);
}

/// Takes beams with all their echoes, each by its number.
Sample beams_with_echoes(BeamSource& log, uint64_t seed) {
  log.rewind();
  const double rate = double(kSampledBeams) / double(std::max<size_t>(1, log.size()));
  BeamLog chosen, chunk;
  size_t beam = 0;
  bool take = false, started = false;
  while (log.next(chunk)) {
    if (!chunk.extra.count(kEchoColumn)) return {};
    if (!started) chosen = chunk.like();
    started = true;
    const std::vector<bool> first = begins_beam(chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (first[i]) {
        take = uniform_from_bits(random_bits(seed, uint32_t(beam++), Purpose::kCluster)) < rate;
      }
      if (take) chosen.append(chunk, i);
    }
  }
  Sample sample{chosen, echoes_of(chosen)};
  keep_first_echoes(sample.beams);
  return sample;
}

}  // namespace

EchoGrainReport learn_grain_of_echoes(elements::Model& model, BeamSource& log, uint64_t seed) {
  EchoGrainReport report;
  if (model.sensor.empty() || model.ellipsoids.empty()) return report;
  StillBeams without_movers(log);
  const Sample sample = beams_with_echoes(without_movers, seed);
  if (sample.echoes == 0) return report;
  LogInfo info;
  info.sensor = model.sensor;
  info.sensor_file = model.sensor_file;
  const sensor::Sensor sensor = sensor::sensor_of_log("model", info);
  simulate::Instrument instrument;
  instrument.beam = sensor.beam;
  instrument.sub_rays = sensor::spread_sub_rays(sensor.beam, kSubRays);
  instrument.receiver = radiometry::receiver_options(sensor);
  const simulate::Reflection reflection(radiometry::load_materials(""), sensor.wavelength_m);
  trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  const simulate::DynamicWorld still(world);
  simulate::EchoOptions options;
  options.seed = seed;
  const auto simulated = [&](double grain_m) {
    model.grain.scale_ellipsoids_to(grain_m);
    world.update_grain();
    BeamLog beams = sample.beams;
    simulate::EchoMaker(still, reflection, instrument, options).answer(0, beams);
    return echoes_of(beams);
  };
  report.learnt = true;
  report.real = sample.echoes;
  double fine = std::log(kLeastGrain), coarse = std::log(kMostGrain);
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (fine + coarse);
    report.simulated = simulated(std::exp(middle));
    (report.simulated > report.real ? fine : coarse) = middle;
  }
  return report;
}

}  // namespace underbrush::calibrate
