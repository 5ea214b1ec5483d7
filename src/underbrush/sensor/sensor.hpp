/// \file
/// What a lidar is: its channels, its timing, its limits; and the catalogue of known ones.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/sensor/beam.hpp"
#include "underbrush/sensor/shots.hpp"
#include "underbrush/sensor/signal.hpp"

namespace underbrush {
/// Sensors, their scan patterns, and raw scans turned into beams.
namespace sensor {

/// One laser–detector pair of a sensor.
struct Channel {
  double elevation_rad = 0;  ///< Above the sensor's horizontal plane.
  double azimuth_rad = 0;    ///< Counter-clockwise from the azimuth of the firing.
  double time_s = 0;         ///< After the start of the firing; in [0, firing period).
  double z_m = 0;            ///< Height of the beam's origin above the sensor's origin.
};

/// How the beams of a sensor cover its field of view.
enum class Kind {
  kSpinning,  ///< All channels fire again and again while the head turns.
  kRaster,    ///< Lines of a raster, from a sensor that stands or moves.
  kSequence,  ///< A list of shots: a sweep over part of a turn, or directions from a file.
};

/// A lidar. Its frame: x forward, y left, z up; azimuth 0 = forward, counter-clockwise positive.
struct Sensor {
  std::string name;                  ///< Catalogue name.
  std::string title;                 ///< Maker and model.
  std::vector<std::string> sources;  ///< Where the values come from; [memory] = unchecked.
  Kind kind = Kind::kSpinning;
  double rate_hz = 10;  ///< Revolutions or frames a second.
  /// Of spinning sensors and sweeps. Index = ring. Which end is ring 0: the data file says.
  std::vector<Channel> channels;
  double firing_period_s = 0;    ///< All channels fire once in it; without channels, a shot.
  bool clockwise = true;         ///< Direction of rotation, seen from above.
  double start_azimuth_rad = 0;  ///< Where a revolution begins.
  int firings_per_packet = 1;    ///< Firings sent in one data packet, taken to share a pose.
  Raster raster;                 ///< Of `kRaster`.
  std::vector<Shot> shots;       ///< Of `kSequence`: a cycle, in order of time.
  double cycle_s = 0;            ///< Of `kSequence`: the shots repeat after it.
  double min_range_m = 0;
  double max_range_m = 120;
  double range_sigma_m = 0;       ///< σ of the range.
  double range_resolution_m = 0;  ///< Step of the reported range.
  BeamShape beam;
  std::array<int, 2> sub_rays{9, 9};  ///< Suggested for super-sampling: columns, rows.
  SignalChain signal;
  double wavelength_m = 0;

  double firings_per_revolution() const { return 1 / (rate_hz * firing_period_s); }
  /// Azimuth between firings (rad, positive).
  double azimuth_step_rad() const;
  double beams_per_s() const;
  /// Spinning sensors: channels · firings; others: `firings_per_packet` shots.
  size_t beams_per_packet() const;
  /// +1 or −1: the sign of the azimuth's change with time.
  double turn() const { return clockwise ? -1 : 1; }
  /// Channels in the order in which they fire: by time, then ring.
  std::vector<uint16_t> firing_order() const;

  /// Sensors that do not spin: their cycle's duration and number of shots, shot `k` of it, and how
  /// many shots come before `time_s` after the start of a first cycle.
  double shot_cycle_s() const;
  uint64_t shots_per_cycle() const;
  Shot shot(uint64_t k) const;
  uint64_t shots_before(double time_s) const;
  /// Throws `std::invalid_argument` where a value is not finite or out of its range.
  void check() const;
};

/// The sensor of the catalogue with this name, or the one described by the YAML file at this path
/// (docs/reference/sensor-files.md has the schema). Throws `std::invalid_argument`, naming the
/// nearest sensor, if it is neither, `FormatError` if the file is malformed.
Sensor load(std::string_view name_or_yaml_path);

/// Names of the catalogue, sorted.
std::vector<std::string> names();

}  // namespace sensor
}  // namespace underbrush
