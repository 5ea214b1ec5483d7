/// \file
/// The verb `simulate`: a world and beams in, a log out.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/rig_source.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::pipeline {

/// Beams that `simulate` answers at a time; each may have up to 16 echoes.
inline constexpr size_t kSimulatedBeams = 1 << 18;

/// The beams of a sensor along a trajectory, as misses. A trajectory of one pose is one scan.
class SensorBeams : public SeekableSource {
 public:
  /// Throws `std::invalid_argument` for a trajectory without poses or with poses more than an hour
  /// apart, of which one must be wrong.
  SensorBeams(sensor::Sensor sensor, Trajectory world_from_sensor);
  SensorBeams(const SensorBeams&) = delete;
  SensorBeams& operator=(const SensorBeams&) = delete;
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size(); }
  void rewind() override { source_.rewind(); }
  size_t seek(size_t beam) override { return source_.seek(beam); }
  bool next(BeamLog& chunk) override { return source_.next(chunk); }
  /// The trajectory; for one pose, that of the whole scan.
  const Trajectory& path() const { return path_; }

 private:
  Trajectory path_;
  sensor::PatternSource source_;
};

/// Makes the beams of a rig along the trajectory of its vehicle. Throws `std::invalid_argument` as
/// `SensorBeams` does and for a single pose.
std::unique_ptr<perception::RigSource> rig_beams(const perception::Rig& rig,
                                                 const Trajectory& world_from_vehicle);

/// Finds the sensor of a log for `Simulation`; `file` is the name of the log in messages. The
/// sensor is looked up when it is needed; the log must outlive the function.
Simulation::SensorOf sensor_of(const std::string& file, const BeamSource& log);

/// The numbers of a simulated log, whose rows are echoes and misses.
struct SimulateCounts {
  size_t beams = 0, rows = 0, hits = 0;
  double seconds = 0;  ///< s; spent on answers, without reading and writing.
  /// The reason where beams were answered and none met anything; see `why_nothing_is_hit`.
  std::vector<std::string> warnings = {};
};

/// A function that is called with the number of beams that are done and that of all.
using SimulateProgress = std::function<void(size_t, size_t)>;

/// Answers the beams of a source and passes the answered log to `write`, which reads it to its end.
/// Memory grows with a chunk.
SimulateCounts simulate_log(Simulation& simulation, BeamSource& beams,
                            const std::function<void(BeamSource&)>& write,
                            const SimulateProgress& progress = {});
/// Answers the beams of a source into memory.
BeamLog simulate_log(Simulation& simulation, BeamSource& beams,
                     const SimulateProgress& progress = {}, SimulateCounts* counts = nullptr);
/// Answers the beams of a log in memory. Extra columns of the beams are kept.
BeamLog simulate_log(Simulation& simulation, BeamLog beams);

/// Answers the beams of a log in memory by a model or scene, which is prepared for it alone.
BeamLog simulate_log(const elements::Model& model, BeamLog beams,
                     const SimulateOptions& options = {});

}  // namespace underbrush::pipeline
