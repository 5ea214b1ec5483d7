#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

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

/// Some beams of a log, the mean number of echoes of those that have any, and the greatest.
struct Sample {
  BeamLog beams;
  double echoes = 0;
  int most = 0;
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

int most_echoes(const BeamLog& log) {
  const auto& echo = std::get<std::vector<uint8_t>>(log.extra.at(kEchoColumn));
  return echo.empty() ? 0 : *std::max_element(echo.begin(), echo.end());
}

double azimuth(const Vec3f& d) { return std::atan2(double(d.y()), double(d.x())); }

/// The steps in azimuth from packet to packet of each ring, which are those of its columns.
class AzimuthSteps {
 public:
  void add(const BeamLog& log, size_t i) {
    const double now = azimuth(log.direction[i]);
    const auto [at, is_first] = last_.try_emplace(log.ring[i], log.packet[i], now);
    auto& [packet, before] = at->second;
    if (is_first || packet == log.packet[i]) return;
    const double step = std::abs(std::remainder(now - before, 2 * std::numbers::pi));
    if (step > 0 && steps_.size() < kMost) steps_.push_back(step);
    at->second = {log.packet[i], now};
  }
  /// rad; 0 where there are none.
  double median() {
    if (steps_.empty()) return 0;
    const auto middle = steps_.begin() + std::ptrdiff_t(steps_.size() / 2);
    std::nth_element(steps_.begin(), middle, steps_.end());
    return *middle;
  }

 private:
  static constexpr size_t kMost = 1 << 17;
  std::map<uint16_t, std::pair<uint32_t, double>> last_;  // the packet and its first azimuth
  std::vector<double> steps_;
};

/// Turns beams about the vertical.
void turn(BeamLog& beams, double angle_rad) {
  const Eigen::AngleAxisf by(float(angle_rad), Vec3f::UnitZ());
  for (Vec3f& d : beams.direction) d = by * d;
}

/// Takes beams with all their echoes, each by its number, and turns them by half a step to where
/// no beam of the log is: beams that the model was fitted to have fewer echoes than others.
Sample beams_with_echoes(BeamSource& log, uint64_t seed) {
  log.rewind();
  const double rate = double(kSampledBeams) / double(std::max<size_t>(1, log.size()));
  BeamLog chosen, chunk;
  size_t beam = 0;
  bool take = false, started = false;
  AzimuthSteps steps;
  while (log.next(chunk)) {
    if (!chunk.extra.count(kEchoColumn)) return {};
    if (!started) chosen = chunk.like();
    started = true;
    const std::vector<bool> first = begins_beam(chunk);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (first[i]) {
        take = uniform_from_bits(random_bits(seed, uint32_t(beam++), Purpose::kCluster)) < rate;
      }
      if (first[i]) steps.add(chunk, i);
      if (take) chosen.append(chunk, i);
    }
  }
  Sample sample{chosen, echoes_of(chosen), most_echoes(chosen)};
  keep_first_echoes(sample.beams);
  turn(sample.beams, 0.5 * steps.median());
  return sample;
}

}  // namespace

EchoGrainReport learn_grain_of_echoes(elements::Model& model, BeamSource& log, uint64_t seed) {
  EchoGrainReport report;
  if (model.sensor.empty() || model.ellipsoids.empty()) return report;
  StillBeams without_movers(log);
  const Sample sample = beams_with_echoes(without_movers, seed);
  if (sample.most < 2) return report;
  LogInfo info;
  info.sensor = model.sensor;
  info.sensor_file = model.sensor_file;
  const sensor::Sensor sensor = sensor::sensor_of_log("model", info);
  simulate::Instrument instrument;
  instrument.beam = sensor.beam;
  instrument.sub_rays = sensor::spread_sub_rays(sensor.beam, kSubRays);
  instrument.receiver = radiometry::receiver_options(sensor);
  instrument.receiver.mode = radiometry::ReturnMode::kAll;
  instrument.receiver.max_echoes = sample.most;
  if (!model.all_echoes) instrument.fitted_beam = sensor.beam;
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
