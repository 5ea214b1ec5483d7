#include "underbrush/pipeline/requested_beams.hpp"

#include "underbrush/core/range_unit.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::pipeline {

RequestedBeams::RequestedBeams(std::unique_ptr<BeamSource> log, std::string name,
                               std::optional<sensor::Sensor> sensor)
    : source_(std::move(log)), name_(std::move(name)), sensor_(std::move(sensor)) {
  require_metres(*source_, "simulate");
}

RequestedBeams::RequestedBeams(sensor::Sensor sensor, const Trajectory& world_from_sensor)
    : sensor_(std::move(sensor)) {
  auto beams = std::make_unique<SensorBeams>(*sensor_, world_from_sensor);
  path_ = beams->path();
  source_ = std::move(beams);
}

RequestedBeams::RequestedBeams(const perception::Rig& rig, const Trajectory& world_from_vehicle)
    : path_(world_from_vehicle) {
  auto beams = rig_beams(rig, world_from_vehicle);
  rig_ = beams->sensors();
  source_ = std::move(beams);
}

Simulation RequestedBeams::simulation(const TracedWorld& world,
                                      const SimulateOptions& options) const {
  if (!rig_.empty()) return {world, options, rig_};
  if (sensor_) return {world, options, [sensor = *sensor_](const char*) { return sensor; }};
  return {world, options, sensor_of(name_, *source_)};
}

}  // namespace underbrush::pipeline
