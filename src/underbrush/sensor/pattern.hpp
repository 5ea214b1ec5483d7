/// \file
/// The beams that a sensor fires along a trajectory.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// Every beam that a spinning sensor fires in [start_s, end_s), as misses, in chunks.
///
/// Firing f = 0, 1, … is at t = start_s + f·period; channel c fires at t + c.time, at azimuth
/// start_azimuth ± 2π·rate·(t + c.time − start_s) + c.azimuth, from the pose interpolated at that
/// time, c.z above the sensor's origin. `scan` counts revolutions from 0, `packet` packets within
/// the revolution. A scan's reference time and pose are those of its first beam. Beams are in order
/// of time, then ring. Memory: a chunk and one `ScanInfo` per revolution.
class PatternSource : public BeamSource {
 public:
  /// Throws `std::invalid_argument` where end_s < start_s, a value is not finite, there are more
  /// than 2³² revolutions, or the trajectory has no pose for a beam. `trajectory` must outlive the
  /// source.
  PatternSource(Sensor sensor, const Trajectory& trajectory, double start_s, double end_s,
                size_t chunk_size = 1 << 20);

  const LogInfo& info() const override { return info_; }
  size_t size() const override { return size_; }
  void rewind() override { firing_ = 0; }
  bool next(BeamLog& chunk) override;

 private:
  void fire(size_t firing, size_t at, BeamLog& chunk) const;
  Pose pose(double time_s) const;

  Sensor sensor_;
  const Trajectory& trajectory_;
  double start_s_, end_s_;
  size_t chunk_firings_, firings_ = 0, size_ = 0, firing_ = 0;
  std::vector<uint16_t> order_;
  LogInfo info_;
};

/// The same in memory.
BeamLog beams(const Sensor& sensor, const Trajectory& trajectory, double start_s, double end_s);

}  // namespace underbrush::sensor
