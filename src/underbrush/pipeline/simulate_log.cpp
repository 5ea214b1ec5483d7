#include "underbrush/pipeline/simulate_log.hpp"

#include <cstdio>

#include "underbrush/core/beam_window.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/read_ahead.hpp"
#include "underbrush/pipeline/out_of_reach.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::pipeline {
namespace {

void check_poses(const Trajectory& path) {
  constexpr double kLongestS = 3600;
  require(!path.empty(), "simulate: the trajectory has no pose");
  for (size_t k = 1; k < path.poses().size(); ++k) {
    const double gap_s = path.poses()[k].time_s - path.poses()[k - 1].time_s;
    if (gap_s <= kLongestS) continue;
    char text[120];
    std::snprintf(text, sizeof text, "poses %zu and %zu: %.1f s apart, more than an hour", k, k + 1,
                  gap_s);
    throw std::invalid_argument(text);
  }
}

Trajectory whole_path(const sensor::Sensor& sensor, Trajectory path) {
  check_poses(path);
  return path.poses().size() == 1 ? sensor::one_scan(sensor, path.poses().front())
                                  : std::move(path);
}

sensor::Sensor named_sensor(const std::string& file, const LogInfo& log, const char* what) {
  if (!log.sensor.empty()) return sensor::sensor_of_log(file, log);
  throw std::invalid_argument(std::string("simulate: ") + what +
                              ", but the log does not name its sensor");
}

BeamRange range_in(size_t beams, const SimulateOptions& options) {
  const BeamRange range = beam_range(options.beams);
  require(options.beams.empty() || range.end <= beams, "simulate: beams ends beyond the last beam");
  return range;
}

/// Source that shows progress as a simulation is read.
class Watched : public BeamSource {
 public:
  Watched(simulate::SimulatedSource& source, const SimulateProgress& progress)
      : source_(source), progress_(progress) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override {
    if (!source_.next(chunk)) return false;
    if (progress_) progress_(source_.beams(), source_.size());
    return true;
  }

 private:
  simulate::SimulatedSource& source_;
  const SimulateProgress& progress_;
};

/// Reads the beams of a log from where it stands into memory.
BeamLog all_of(BeamSource& log) {
  BeamLog out, chunk;
  while (log.next(chunk)) {
    if (out.empty()) {
      out = chunk.like();
      out.reserve(log.size());
    }
    out.append(chunk, 0, chunk.size());
  }
  out.info = log.info();
  return out;
}

}  // namespace

SensorBeams::SensorBeams(sensor::Sensor sensor, Trajectory world_from_sensor)
    : path_(whole_path(sensor, std::move(world_from_sensor))),
      source_(std::move(sensor), path_, path_.poses().front().time_s, path_.poses().back().time_s,
              kSimulatedBeams) {}

std::unique_ptr<perception::RigSource> rig_beams(const perception::Rig& rig,
                                                 const Trajectory& world_from_vehicle) {
  check_poses(world_from_vehicle);
  require(world_from_vehicle.poses().size() >= 2, "a vehicle needs at least two poses");
  return std::make_unique<perception::RigSource>(rig, world_from_vehicle, kSimulatedBeams);
}

Simulation::SensorOf sensor_of(const std::string& file, const BeamSource& log) {
  return [file, &log](const char* what) { return named_sensor(file, log.info(), what); };
}

SimulateCounts simulate_log(Simulation& simulation, BeamSource& beams,
                            const std::function<void(BeamSource&)>& write,
                            const SimulateProgress& progress) {
  // The file of a sensor without a name is read twice. A short one is kept in memory for that.
  constexpr size_t kShort = 1 << 18;
  const bool is_named = !beams.info().sensor.empty() || !beams.info().sensor_file.empty();
  const bool keeps = !is_named && beams.size() <= kShort && dynamic_cast<SeekableSource*>(&beams);
  BeamLog kept;
  MemorySource memory(kept, 1 << 16);
  BeamSource& source = keeps ? memory : beams;
  beams.rewind();
  if (keeps) kept = all_of(beams);
  simulation.recognise(source);
  const BeamRange range = range_in(source.size(), simulation.options());
  const std::vector<size_t> fired = simulation.fired_in(source, range.first);
  BeamWindow part(source, range.first, range.end);
  metrics::Bounds sensor;
  simulate::SimulatedSource simulated(
      [&](size_t first_beam, BeamLog& chunk) {
        for (const Vec3& origin : chunk.origin) sensor.add(origin);
        if (first_beam == 0) simulation.continue_after(fired);
        simulation.answer(range.first + first_beam, chunk);
      },
      part, simulation.options().max_range_m);
  if (simulation.options().element_ids) {
    simulated.name_classes(simulation.world().element_classes());
  }
  Watched watched(simulated, progress);
  {
    ReadAhead ahead(watched);  // the next beams are simulated while the last ones are written
    ahead.rewind();
    write(ahead);
  }
  SimulateCounts out{simulated.beams(), simulated.rows(), simulated.hits(), simulated.seconds()};
  if (out.beams > 0 && out.hits == 0) {
    out.warnings.push_back(
        why_nothing_is_hit(sensor, simulation.world().bounds(), simulated.info().max_range_m));
  } else if (const elements::Scene* scene = simulation.world().scene()) {
    std::string elsewhere = ground_elsewhere(sensor, *scene);
    if (!elsewhere.empty()) out.warnings.push_back(std::move(elsewhere));
  }
  if (out.hits > 0) {
    std::string large = larger_than_life(simulation.world().bounds());
    if (!large.empty()) out.warnings.push_back(std::move(large));
  }
  return out;
}

BeamLog simulate_log(Simulation& simulation, BeamSource& beams, const SimulateProgress& progress,
                     SimulateCounts* counts) {
  BeamLog out;
  const auto collect = [&](BeamSource& log) { out = all_of(log); };
  const SimulateCounts done = simulate_log(simulation, beams, collect, progress);
  if (counts) *counts = done;
  return out;
}

BeamLog simulate_log(Simulation& simulation, BeamLog beams) {
  MemorySource source(beams);
  simulation.recognise(source);
  const double max_range_m = simulation.options().max_range_m;
  beams.info.has_misses = true;
  if (max_range_m > 0) beams.info.max_range_m = max_range_m;
  const BeamRange range = range_in(beams.size(), simulation.options());
  if (range.first > 0 || range.end < beams.size()) {
    BeamLog part = beams.like();
    part.append(beams, range.first, range.end);
    beams = std::move(part);
  }
  simulation.answer(range.first, beams);
  if (simulation.options().element_ids) {
    beams.info.element_classes = simulation.world().element_classes();
  }
  return beams;
}

BeamLog simulate_log(const elements::Model& model, BeamLog beams, const SimulateOptions& options) {
  const TracedWorld world(model, matter_of(options));
  const LogInfo& info = beams.info;
  Simulation simulation(world, options,
                        [&](const char* what) { return named_sensor("log", info, what); });
  return simulate_log(simulation, std::move(beams));
}

}  // namespace underbrush::pipeline
