/// \file
/// This file makes the beams that all sensors of a rig fire while the vehicle moves.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/rig.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::perception {

/// The sensors of a rig, loaded.
std::vector<sensor::Sensor> sensors_of(const Rig& rig);

/// A part of the time in which the sensors of a rig fire, s.
struct FiringTime {
  double start_s = 0;              ///< The time at which all sensors began to fire.
  double from_s = 0, until_s = 0;  ///< Beams of [from_s, until_s).
};

/// A source of every beam that the sensors of a rig fire, as misses, in order of time and then of
/// sensor. The extra column `sensor` has the index of the sensor in the rig.
///
/// `scan` counts cycles of the rig, which begin with the trajectory and last as long as those of
/// its first sensor; their poses are those of the vehicle. `packet` counts those of each sensor's
/// own scans, times the number of sensors, plus the sensor's index. Times are by the vehicle's
/// clock. The limits of range are the widest of all sensors. The log names no sensor, as it has
/// several. The parts of a time are, one after the other, the whole.
class RigSource : public BeamSource {
 public:
  /// Throws `std::invalid_argument` for a trajectory of less than two poses or without a pose at
  /// the time of a beam, and as `sensors_of` does.
  RigSource(const Rig& rig, const Trajectory& world_from_vehicle, size_t chunk_size = 1 << 18);
  /// The beams of a part of the time, in which `sensors` are those of the rig
  /// (`sensors_of`). `world_from_vehicle` has a pose for all of it.
  RigSource(const Rig& rig, std::vector<sensor::Sensor> sensors,
            const Trajectory& world_from_vehicle, const FiringTime& time,
            size_t chunk_size = 1 << 18);
  ~RigSource() override;
  const LogInfo& info() const override { return info_; }
  size_t size() const override;
  void rewind() override;
  bool next(BeamLog& chunk) override;
  const std::vector<sensor::Sensor>& sensors() const { return sensors_; }
  /// The number of beams that each sensor fired before this part of the time.
  std::vector<size_t> fired_before() const;

 private:
  struct Stream;
  /// The sensor of the next beam; none at the end.
  std::optional<size_t> earliest() const;
  /// The number of beams of its chunk that a sensor fires before another one does.
  size_t beams_in_a_row(size_t sensor) const;

  std::vector<sensor::Sensor> sensors_;
  std::vector<std::unique_ptr<Stream>> streams_;
  LogInfo info_;
  double start_s_ = 0;
  uint32_t last_scan_ = 0;
  size_t chunk_size_;
};

}  // namespace underbrush::perception
