/// \file
/// This file describes a lidar, with its channels, timing and limits, and gives access to the
/// catalogue of known ones.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/sensor/risley.hpp"
#include "underbrush/sensor/shots.hpp"
#include "underbrush/sensor/signal.hpp"

namespace underbrush {
/// Sensors: their properties, their scan patterns, and the conversion of raw scans to beams.
namespace sensor {

/// A channel of a sensor, one laser with its detector.
struct Channel {
  double elevation_rad = 0;  ///< Above the sensor's horizontal plane.
  double azimuth_rad = 0;    ///< Counter-clockwise from the azimuth of the firing.
  double time_s = 0;         ///< After the start of the firing; in [0, firing period).
  double z_m = 0;            ///< Height of the beam's origin above the sensor's origin.
};

/// The way in which the beams of a sensor cover its field of view.
enum class Kind {
  kSpinning,  ///< All channels fire again and again while the head turns.
  kRaster,    ///< Lines of a raster, from a sensor that stands or moves.
  kSequence,  ///< A list of shots: a sweep over part of a turn, or directions from a file.
  kRisley,    ///< Lasers behind rotating prisms.
};

/// A lidar. Its frame has x forward, y left and z up; azimuth 0 is forward, and counter-clockwise
/// is positive.
struct Sensor {
  std::string name;                  ///< Catalogue name.
  std::string file;                  ///< The data file (YAML), if not of the catalogue.
  std::string title;                 ///< Maker and model.
  std::vector<std::string> sources;  ///< Sources of the values; [memory] = unchecked.
  Kind kind = Kind::kSpinning;
  double rate_hz = 10;  ///< Revolutions or frames per second.
  /// The channels of a spinning sensor or a sweep. The index is the ring; the data file defines
  /// which end is ring 0.
  std::vector<Channel> channels;
  /// Time in which all channels fire once; without channels, time of a shot.
  double firing_period_s = 0;
  bool clockwise = true;         ///< Direction of rotation, seen from above.
  double start_azimuth_rad = 0;  ///< Azimuth at which a revolution begins.
  int firings_per_packet = 1;    ///< Firings in a data packet, which are taken to share a pose.
  Raster raster;                 ///< For `kRaster`.
  std::vector<Shot> shots;       ///< For `kSequence`: the shots of a cycle, in order of time.
  double cycle_s = 0;            ///< For `kSequence`: the duration of a cycle.
  Risley risley;                 ///< For `kRisley`.
  double min_range_m = 0;
  double max_range_m = 120;
  double range_sigma_m = 0;       ///< σ of the range.
  double range_resolution_m = 0;  ///< Step of the reported range.
  BeamShape beam;
  std::array<int, 2> sub_rays{9, 9};  ///< Columns and rows suggested for super-sampling.
  SignalChain signal;
  double wavelength_m = 0;

  double firings_per_revolution() const { return 1 / (rate_hz * firing_period_s); }
  /// Angle between firings, rad, positive.
  double azimuth_step_rad() const;
  double beams_per_s() const;
  /// The number of rings: of channels, of lasers behind prisms or of rows of a raster; 1 for
  /// others.
  size_t rings() const;
  /// For spinning sensors, channels · firings; for others, `firings_per_packet` shots.
  size_t beams_per_packet() const;
  /// The sign of the azimuth's change with time, +1 or −1.
  double turn() const { return clockwise ? -1 : 1; }
  /// The channels in the order in which they fire: by time, then ring.
  std::vector<uint16_t> firing_order() const;

  /// The duration of a cycle of shots, s; with prisms, of a frame, which does not repeat. This
  /// function and the next three are for sensors that do not spin.
  double shot_cycle_s() const;
  /// The number of shots of a cycle.
  uint64_t shots_per_cycle() const;
  /// Shot `k`; its number and its time count from the start of the first cycle.
  Shot shot(uint64_t k) const;
  /// The number of shots before `time_s` after the start of the first cycle.
  uint64_t shots_before(double time_s) const;
  /// Throws `std::invalid_argument` where a value is not finite or out of its range.
  void check() const;
};

/// The name of the way in which a sensor's beams cover its field of view: "spinning", "raster",
/// "sweep" (channels over part of a turn), "directions" (shots from a file) or "risley".
std::string_view kind_name(const Sensor& sensor);

/// Loads a sensor: from the catalogue by name, or else from the YAML file at this path, whose
/// schema is in docs/reference/sensor-files.md. Throws `std::invalid_argument`, which names the
/// most similar sensor, if there is neither, and `FormatError` if the file is malformed.
Sensor load(std::string_view name_or_yaml_path);

/// Loads the sensor that a log names: the data file that the log carries, or else as `load`. Throws
/// `FormatError`, which names `log`, if there is no name or the data file is malformed.
Sensor sensor_of_log(const std::string& log, const LogInfo& info);

/// The names of the catalogue, sorted.
std::vector<std::string> names();

}  // namespace sensor
}  // namespace underbrush
