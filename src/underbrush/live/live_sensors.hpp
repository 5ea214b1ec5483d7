/// \file
/// The sensors of a vehicle in a world, which fire on request.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "underbrush/live/firing.hpp"
#include "underbrush/perception/rig_source.hpp"
#include "underbrush/pipeline/simulation.hpp"

namespace underbrush::live {

/// A sensor, or all sensors of a rig, in a world. A firing depends on its request alone. The beams
/// of firings that follow each other are, to the bit, those of `pipeline::simulate_log` for a
/// trajectory with the same poses, if each request repeats the pose before the last of its time.
class LiveSensors {
 public:
  /// `world` must outlive this, and nobody else may fire into it meanwhile, because its actors are
  /// moved. Throws as `pipeline::Simulation` does.
  LiveSensors(pipeline::TracedWorld& world, const pipeline::SimulateOptions& options,
              sensor::Sensor sensor);
  /// The constructor for a rig. Beams have the column `sensor` and are in order of time.
  LiveSensors(pipeline::TracedWorld& world, const pipeline::SimulateOptions& options,
              perception::Rig rig);

  /// The number of beams of a firing, in which the echoes of a beam do not count apart.
  double beams_in(const Firing& firing) const;
  /// Answers the beams of a firing. Throws `std::invalid_argument` for times or poses that are not
  /// finite or not in order, a vehicle without poses for all of the time, and unknown actors.
  BeamLog fire(const Firing& firing);

  const std::vector<sensor::Sensor>& sensors() const { return sensors_; }
  /// The mounted sensors; one without a rig stands in the vehicle's origin.
  const perception::Rig& rig() const { return rig_; }
  /// The names of everything that moves, each once.
  std::vector<std::string> actors() const;

 private:
  void move_actors(const Firing& firing);
  BeamLog answered(size_t first_beam, uint32_t first_scan, BeamSource& beams);
  BeamLog fire_one(const Firing& firing, const Trajectory& path);
  BeamLog fire_rig(const Firing& firing, const Trajectory& path);

  pipeline::TracedWorld& world_;
  bool is_rig_;
  perception::Rig rig_;
  std::vector<sensor::Sensor> sensors_;
  pipeline::Simulation simulation_;
};

/// The trajectory of a motion up to `until_s`. Throws `std::invalid_argument` for one without
/// poses, a velocity of several poses, and half a turn or more.
Trajectory trajectory_of(const Motion& motion, double until_s);

}  // namespace underbrush::live
