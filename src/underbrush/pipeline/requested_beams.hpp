/// \file
/// The beams that a request to `simulate` names, and the sensor that fires them.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/pose.hpp"
#include "underbrush/perception/rig.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::pipeline {

/// The beams of a log, of a sensor on a trajectory, or of all sensors of a vehicle.
class RequestedBeams {
 public:
  /// The beams of a log, which messages call `name`. The instrument is that of `sensor`, or else of
  /// the log's own sensor.
  RequestedBeams(std::unique_ptr<BeamSource> log, std::string name,
                 std::optional<sensor::Sensor> sensor);
  /// The beams of a sensor. Throws as `SensorBeams` does.
  RequestedBeams(sensor::Sensor sensor, const Trajectory& world_from_sensor);
  /// The beams of a vehicle's sensors. Throws as `rig_beams` does.
  RequestedBeams(const perception::Rig& rig, const Trajectory& world_from_vehicle);

  BeamSource& source() const { return *source_; }
  /// The trajectory of the sensor or the vehicle; empty for a log.
  const Trajectory& path() const { return path_; }
  /// Returns the simulation that answers these beams, which must outlive it. Throws as its
  /// constructor does.
  Simulation simulation(const TracedWorld& world, const SimulateOptions& options) const;

 private:
  std::unique_ptr<BeamSource> source_;
  std::string name_;
  std::optional<sensor::Sensor> sensor_;
  std::vector<sensor::Sensor> rig_;
  Trajectory path_;
};

}  // namespace underbrush::pipeline
