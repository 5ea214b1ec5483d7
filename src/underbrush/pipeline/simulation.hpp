/// \file
/// This file answers beams: it is the one place where the answer that a user gets is made.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::pipeline {

/// A world with the options of `simulate`, ready to answer beams: as thin rays, or with
/// `super_sample` as an instrument, of one sensor or of all sensors of a rig.
class Simulation {
 public:
  /// Returns the sensor of the beams, or throws `std::invalid_argument`, because the option `what`
  /// needs one. It is called only where a sensor is needed.
  using SensorOf = std::function<sensor::Sensor(const char* what)>;

  /// `world` must outlive this, and have been prepared with the matter of the options
  /// (`matter_of`). In a world of regions, only the regions that the beams can reach are opened;
  /// `sensor_of` is then called again, and the options limit the memory. Throws
  /// `std::invalid_argument` for options out of range or without effect, and for a material that
  /// the table does not have.
  Simulation(const TracedWorld& world, SimulateOptions options, const SensorOf& sensor_of = {});
  /// The constructor for beams of a rig, which have the column `sensor` (`perception::RigSource`).
  /// All sensors measure the same matter: they share the seed, and their beams have different
  /// numbers. Waveforms are those of the first sensor.
  Simulation(const TracedWorld& world, const SimulateOptions& options,
             const std::vector<sensor::Sensor>& rig);
  Simulation(Simulation&&) noexcept;
  ~Simulation();

  /// Answers beams in place. `first_beam` is the number of the first beam in its log. An instrument
  /// may give several rows per beam. Where the world's model has range offsets of the channels of
  /// this sensor (`Model::channels_of`), they are added to the ranges. Beams of a rig come in
  /// order: from the first, of which `first_beam` is 0, or after `continue_after`. The answer
  /// depends neither on chunks nor on threads. Throws `DataError` where the regions that a beam can
  /// reach do not fit into the memory.
  void answer(size_t first_beam, BeamLog& beams);

  /// Sets the number of beams that each sensor of a rig has fired before those of the next call of
  /// `answer`.
  void continue_after(std::vector<size_t> fired) { fired_ = std::move(fired); }
  /// Counts the beams of each sensor of a rig among the first `beams` of a source; reads them.
  std::vector<size_t> fired_in(BeamSource& source, size_t beams) const;

  /// Determines whether the log whose beams are simulated was recorded by the sensor of the model's
  /// keyframes. If not, keyframes are not used. Only a log without the name of a sensor is read for
  /// this (`KeyframeCache::serves`). Before the first call, sensors without a name count as the
  /// same. `simulate_log` calls it, and sensors of a rig are known.
  void recognise(BeamSource& log);

  const TracedWorld& world() const { return *world_; }
  const SimulateOptions& options() const { return options_; }
  /// The number of sub-rays of a beam, 0 for thin rays; and of those that were traced so far.
  size_t sub_rays() const;
  size_t rays_traced() const;
  /// Whether intensities follow from the light that models have learnt, and not from radiometry and
  /// materials.
  bool uses_learnt_light() const;
  /// The sensor of an instrument, of a rig the first one; without a name for thin rays.
  const sensor::Sensor& sensor() const;
  /// Whether keyframes of the world's model are used for such beams.
  bool keyframes_serve(const LogInfo& beams) const;

 private:
  class OfSensor;
  void prepare();
  /// Makes the answers of a world, which must outlive them.
  void use(const TracedWorld& world);
  /// Reads regions and uses the world's part with them.
  void enter(const std::vector<uint32_t>& regions);
  /// Answers beams by the world in use.
  void answer_here(size_t first_beam, BeamLog& beams);

  const TracedWorld* world_;
  SimulateOptions options_;
  std::vector<SensorOf> sensor_of_;  ///< One for each sensor.
  std::unique_ptr<regions::OpenRegions> open_;
  std::unique_ptr<TracedWorld> part_;  ///< The part of a world of regions that is open.
  bool uses_keyframes_ = true;         ///< Whether keyframes may answer, by `recognise`.
  size_t rays_before_ = 0;             ///< Rays traced in other parts.
  bool rig_ = false;
  std::vector<LogInfo> limits_;  ///< The limits of each sensor of a rig.
  std::vector<std::unique_ptr<OfSensor>> answers_;
  std::vector<size_t> fired_;  ///< The number of beams of each sensor of a rig so far.
};

/// Whether `change_world` has something to do.
bool changes_world(const SimulateOptions& options);
/// Adds the actors of the options to a world, and replaces τ and the grain of all its models unless
/// they are 0. Throws as `actors::read_actors` does.
void change_world(World& world, const SimulateOptions& options);

/// The matter of `SimulateOptions`, for `TracedWorld`. Throws `std::invalid_argument` for a word
/// that is none.
Matter matter_of(const SimulateOptions& options);

}  // namespace underbrush::pipeline
