/// \file
/// This file makes the beams that a sensor fires along a trajectory.
#pragma once
#include <optional>

#include "underbrush/core/beam_window.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// A source of every beam that a sensor fires in [start_s, end_s), as misses, in chunks.
///
/// A spinning sensor has its firing f = 0, 1, … at t = start_s + f·period. Channel c fires at t +
/// c.time, at azimuth start_azimuth ± 2π·rate·(t + c.time − start_s) + c.azimuth, from c.z above
/// the sensor's origin. Other sensors repeat the shots of a cycle from start_s on, except those
/// with prisms, whose pattern goes on. Every beam has the pose that is interpolated at its time.
///
/// `scan` counts revolutions or frames (1/rate) from 0, and `packet` counts packets within the
/// scan. A scan's reference time and pose are those of its first beam. Beams are in order of time,
/// then ring. Memory is a chunk and one `ScanInfo` for each revolution. A source for a part of the
/// time, in which the numbers of beams are those of all, has scans from `from_s` on alone: that of
/// `from_s` itself has its time and pose from there.
class PatternSource : public SeekableSource {
 public:
  /// Throws `std::invalid_argument` where end_s < start_s, a value is not finite, there are more
  /// than 2³² revolutions, or the trajectory has no pose for a beam. `trajectory` must outlive the
  /// source.
  PatternSource(Sensor sensor, const Trajectory& trajectory, double start_s, double end_s,
                size_t chunk_size = 1 << 20, std::optional<double> from_s = {});

  const LogInfo& info() const override { return info_; }
  size_t size() const override { return size_; }
  /// The number of beams that are fired in [start_s, time_s).
  size_t beams_before(double time_s) const;
  void rewind() override { firing_ = 0; }
  size_t seek(size_t beam) override;
  bool next(BeamLog& chunk) override;

 private:
  size_t firings_before(double time_s) const;
  void start_spinning();
  void start_shooting();
  void add_scan(uint64_t scan, double after_s);
  void fire(size_t firing, size_t at, BeamLog& chunk) const;
  void shoot(size_t begin, size_t end, size_t first, BeamLog& chunk) const;
  Pose pose(double time_s) const;

  Sensor sensor_;
  const Trajectory& trajectory_;
  double start_s_, end_s_, from_s_;
  size_t chunk_size_, firings_ = 0, size_ = 0;
  size_t firing_ = 0;  ///< The next firing, or the next shot.
  std::vector<uint16_t> order_;
  // By place in `order_`: the first place with the same time and azimuth, and the beam at azimuth
  // 0.
  std::vector<size_t> as_;
  std::vector<Vec3> raised_;
  std::vector<uint64_t> first_shot_;  ///< The first shot of each scan from `first_scan_` on.
  uint64_t first_scan_ = 0;
  LogInfo info_;
};

/// Makes the trajectory of a sensor that stands at a pose for one revolution or frame, such as a
/// scanner on its tripod.
Trajectory one_scan(const Sensor& sensor, const StampedPose& pose);

/// Makes every beam that a sensor fires in [start_s, end_s), in memory. Throws as `PatternSource`
/// does.
BeamLog beams(const Sensor& sensor, const Trajectory& trajectory, double start_s, double end_s);

}  // namespace underbrush::sensor
