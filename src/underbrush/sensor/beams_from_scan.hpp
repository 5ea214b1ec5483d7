/// \file
/// A raw scan turned into beams: moved to where each was fired, known faults corrected, misses kept
/// or inferred, all counted.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// How to read a raw scan.
struct BeamOptions {
  /// Give every beam its own origin and orientation along the trajectory; the scan must not have
  /// been motion-compensated. Time: the scan's own per point, else from the azimuth: the scan's
  /// time is the instant at which the scanner faces forward, t = t_scan ± azimuth/2π · revolution.
  std::optional<Sensor> deskew;
  /// Duration of a revolution (s). 0: the mean spacing of those poses of the trajectory that are
  /// within 15 % of the sensor's revolution apart (KITTI: 0.1036), else the sensor's own.
  double revolution_s = 0;
  /// Fault of the recording: every ray is rotated up by this about p × z (KITTI: 0.205°).
  double elevation_offset_rad = 0;
  /// Insert the misses that the format dropped (see `insert_misses`), if it keeps none itself.
  std::optional<Sensor> infer_misses;
  /// A dropped beam of a ring whose elevation is below this is not a miss but unknown: it must have
  /// met the ground or the own vehicle. −13°: in KITTI scans the rings from 41 down have gaps at
  /// azimuths fixed to the vehicle, those above have not.
  double unknown_below_rad = -13 * 0.017453292519943295;
  /// The same for misses that the format recorded; by default all are kept. Beams that the own
  /// robot blocked, or whose returns were filtered out, look like misses there and cannot be told
  /// apart.
  double recorded_unknown_below_rad = -2;
};

/// What became of the points of all scans so far.
struct BeamCounts {
  size_t hits = 0;
  size_t misses_recorded = 0;             ///< In the file; direction from its grid.
  size_t misses_inferred = 0;             ///< Inserted.
  size_t unknown = 0;                     ///< Beams without a return that tell nothing; left out.
  size_t scans_ringed_by_elevation = 0;   ///< Rings could not be told from the file's order.
  std::map<std::string, size_t> skipped;  ///< Points left out, by reason.
};

/// The beams of one scan; `counts` is added to.
///
/// - ring: the file's own number; in an organised scan without one, its row; else recovered from
/// the
///   file's order (KITTI: 0 = top), or, if that does not give as many rings as the sensor has
///   channels, from the elevation (the index of the sensor's channel; counted). Without a sensor
///   a count above 256 is no ring order: all 0.
/// - (0,0,0) and non-finite points of an organised scan are misses, their direction from
/// `find_organised_scan`;
///   where there is no grid they are skipped and counted.
/// - origin: the sensor's origin (heights of single lasers and Ouster's 12 mm are left out). With
///   `deskew`, at the beam's own time; else all beams share the scan's pose.
/// - order: with `deskew` by time, then ring; else the file's, an inferred miss after the return
///   before its gap.
/// - packet: by firing time (without per-point time: by azimuth, from the rear), in bins of the
///   sensor's `firings_per_packet` firings, from 0 in each scan; by azimuth in bins of 2° where no
///   sensor is given.
/// - intensity and extra columns: the file's, 0 for an inferred miss. Inferred misses are flagged
///   `kInferred`. Returns beyond the maximum range are kept.
///
/// Throws `std::invalid_argument` where columns differ in length or a sensor is not valid.
BeamLog beams_from_scan(const PointScan& scan, const Trajectory& trajectory,
                        const BeamOptions& options, BeamCounts& counts);

}  // namespace underbrush::sensor
