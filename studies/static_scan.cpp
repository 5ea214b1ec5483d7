#include "studies/static_scan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "studies/targets.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/simulate/footprint.hpp"

namespace underbrush::studies {
namespace {

constexpr uint32_t kTrainEvery = 5;

/// The lasers [first, end).
struct Lasers {
  int first = 0, end = 0;
};

/// Returns the lasers whose beams meet the target at its distance; of more than `most_lasers` the
/// middle ones.
Lasers lasers_on(const StaticTarget& target, const sensor::Sensor& sensor,
                 const StaticScanOptions& options) {
  Lasers lasers{int(sensor.channels.size()), 0};
  for (size_t c = 0; c < sensor.channels.size(); ++c) {
    const sensor::Channel& channel = sensor.channels[c];
    const double z = options.sensor_height_m + channel.z_m +
                     options.distance_m * std::tan(channel.elevation_rad);
    if (std::abs(z - target.centre_z_m) > target.half_height_m) continue;
    lasers.first = std::min(lasers.first, int(c));
    lasers.end = int(c) + 1;
  }
  require(lasers.end > 0, "study: no laser of the sensor meets the target");
  const int extra = lasers.end - lasers.first - options.most_lasers;
  if (extra > 0)
    lasers = {lasers.first + extra / 2, lasers.first + extra / 2 + options.most_lasers};
  return lasers;
}

/// Returns the beams of one measurement of all directions as the encoder reports them, with the
/// margin if `margin`.
BeamLog one_measurement(const Lasers& lasers, const sensor::Sensor& sensor,
                        const StaticScanOptions& options, bool margin) {
  BeamLog beams;
  beams.info.sensor = sensor.name;
  beams.info.min_range_m = sensor.min_range_m;
  beams.info.max_range_m = sensor.max_range_m;
  beams.info.has_misses = true;
  const int more = margin ? options.margin_lasers : 0;
  const int wider = margin ? options.margin_bearings : 0;
  const int first = std::max(0, lasers.first - more);
  const int end = std::min(int(sensor.channels.size()), lasers.end + more);
  const int left = -(options.bearings / 2) - wider;
  const int bearings = options.bearings + 2 * wider;
  beams.resize(size_t(end - first) * size_t(bearings));
  for (size_t i = 0; i < beams.size(); ++i) {
    const size_t laser = size_t(first) + i / size_t(bearings);
    const sensor::Channel& channel = sensor.channels[laser];
    const double azimuth = (left + int(i % size_t(bearings))) * sensor.beam.encoder_step_rad;
    const double flat = std::cos(channel.elevation_rad);
    beams.origin[i] = {0, 0, options.sensor_height_m + channel.z_m};
    beams.direction[i] =
        Vec3(flat * std::cos(azimuth), flat * std::sin(azimuth), std::sin(channel.elevation_rad))
            .cast<float>();
    beams.ring[i] = uint16_t(laser);
  }
  return beams;
}

/// Measures `pattern` as often as the options ask, for the numbers for which `wanted(measurement)`
/// holds. This stands for the real scanner, so it is not the instrument that is under test, but the
/// ray caster of all generated realities (`simulate::scan`).
template <class Wanted>
BeamLog measured(const trace::World& world, BeamLog pattern, const sensor::Sensor& sensor,
                 const StaticScanOptions& options, const Wanted& wanted) {
  simulate::FootprintOptions beam;
  beam.seed = options.seed;
  beam.shape = sensor.beam;
  beam.sub_rays = options.sub_rays;
  beam.range_sigma_m = options.range_sigma_m;
  BeamLog out = pattern.like();
  for (uint32_t m = 0; m < uint32_t(options.measurements); ++m) {
    if (!wanted(m)) continue;
    pattern.scan.assign(pattern.size(), m);
    pattern.time_s.assign(pattern.size(), m / sensor.rate_hz);
    out.info.scans.push_back({m, pattern.time_s[0], {}});
    out.append(pattern, 0, pattern.size());
  }
  const std::vector<elements::Class> label(world.model().size(), elements::Class::kUnknown);
  simulate::scan(world, label, beam, 0, out);
  out.extra.clear();
  return out;
}

}  // namespace

StaticScan scan_target(const std::string& name, const StaticScanOptions& options) {
  StaticScan out;
  out.sensor = sensor::load(options.sensor);
  require(out.sensor.beam.encoder_step_rad > 0, "study: the sensor has no encoder");
  StaticTarget target = static_target(name, options.distance_m, options.seed);
  out.target = name;
  out.porous = target.porous;
  out.step_rad = out.sensor.beam.encoder_step_rad;
  elements::Model model;
  model.surface = std::move(target.geometry.mesh);
  const trace::World world(model);
  const Lasers lasers = lasers_on(target, out.sensor, options);
  const BeamLog inner = one_measurement(lasers, out.sensor, options, false);
  out.directions = inner.size();
  out.train = measured(world, one_measurement(lasers, out.sensor, options, true), out.sensor,
                       options, [](uint32_t m) { return m % kTrainEvery == 0; });
  out.test =
      measured(world, inner, out.sensor, options, [](uint32_t m) { return m % kTrainEvery != 0; });
  return out;
}

metrics::BearingRangeHistogram histogram_of(const StaticScan& scan, const BeamLog& beams) {
  metrics::BearingRangeHistogram h({scan.step_rad, scan.sensor.range_resolution_m});
  h.add(beams);
  return h;
}

double mean_distance_of_lasers(const metrics::BearingRangeHistogram& real,
                               const metrics::BearingRangeHistogram& simulated) {
  std::map<uint16_t, std::pair<double, int>> lasers;
  for (const metrics::DirectionOverlap& o : direction_overlaps(real, simulated)) {
    auto& [sum, n] = lasers[o.ring];
    sum += o.coefficient, ++n;
  }
  double sum = 0;
  for (const auto& [ring, l] : lasers) sum -= std::log(l.first / l.second);
  return sum / double(lasers.size());
}

BeamLog without_margin(const StaticScan& scan) {
  // Laser and y of the direction, of which each bearing has one.
  std::set<std::pair<uint16_t, float>> tested;
  for (size_t i = 0; i < scan.directions; ++i) {
    tested.emplace(scan.test.ring[i], scan.test.direction[i].y());
  }
  BeamLog out = scan.train.like();
  for (size_t i = 0; i < scan.train.size(); ++i) {
    if (tested.count({scan.train.ring[i], scan.train.direction[i].y()})) out.append(scan.train, i);
  }
  return out;
}

metrics::BearingRangeHistogram simulated_histogram(const StaticScan& scan,
                                                   const elements::Model& model, bool random_ray,
                                                   bool once, int draws, uint64_t seed) {
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.matter = once ? "once" : "anew";
  if (random_ray) options.beam = "random";
  const pipeline::TracedWorld world(model, pipeline::matter_of(options));
  pipeline::Simulation simulation(world, options, [&](const char*) { return scan.sensor; });
  BeamLog beams = scan.test;
  const double duration_s = beams.time_s.back() + 1 / scan.sensor.rate_hz;
  metrics::BearingRangeHistogram out = histogram_of(scan, beams.like());
  for (int k = 0; k < draws; ++k) {
    for (double& time_s : beams.time_s) time_s += k > 0 ? duration_s : 0;
    simulation.answer(size_t(k) * beams.size(), beams);
    out.add(beams);
  }
  return out;
}

}  // namespace underbrush::studies
