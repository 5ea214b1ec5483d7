/// \file
/// This file turns raw scans into beams. Each beam gets the pose at its own time, known faults are
/// corrected, misses are kept or inferred, and everything is counted.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// Options for reading a raw scan.
struct BeamOptions {
  /// If set, every beam gets its own origin and orientation along the trajectory; the scan must not
  /// have been motion-compensated. A beam's time is the scan's own per-point time. Without one it
  /// follows from the azimuth: the scan's time is the instant at which the scanner faces forward,
  /// so that t = t_scan ± azimuth/2π · revolution.
  std::optional<Sensor> deskew;
  /// Duration of a revolution, s. With 0 it is the mean spacing of those neighbouring poses of the
  /// trajectory that are within 15 % of the sensor's revolution apart (KITTI: 0.1036), or, where
  /// there are none, the sensor's own.
  double revolution_s = 0;
  /// A fault of the recording: every ray is rotated up by about this angle about p × z (KITTI:
  /// 0.205°).
  double elevation_offset_rad = 0;
  /// If set, the misses that the format dropped are inserted (`insert_misses`), unless it keeps
  /// some itself.
  std::optional<Sensor> infer_misses;
  /// A dropped beam of a ring whose elevation is below this counts as unknown and not as a miss,
  /// because it must have hit the ground or the own vehicle. The default of −13° fits KITTI, where
  /// the rings from 41 downwards have gaps at azimuths fixed to the vehicle and those above have
  /// none.
  double unknown_below_rad = -13 * 0.017453292519943295;
  /// Recorded misses of rings below this elevation count as unknown; by default all are kept.
  /// Formats do not distinguish misses from beams that the own robot blocked or whose returns were
  /// filtered out.
  double recorded_unknown_below_rad = -2;
  /// Points at this range (m) are misses, which simulators store at their greatest range; 0 = none.
  double no_return_at_m = 0;
};

/// The reason for which recorded misses are skipped.
inline constexpr const char* kNoGrid = "no coordinates, and no grid that gives the direction";

/// Counts of the points of all scans read so far.
struct BeamCounts {
  size_t hits = 0;
  size_t misses_recorded = 0;  ///< Misses in the file; their directions come from its grid.
  size_t misses_inferred = 0;  ///< Misses that were inserted.
  size_t unknown = 0;          ///< Beams without a return that may not be misses; left out.
  size_t scans_ringed_by_elevation = 0;  ///< Scans whose rings do not follow from the file's order.
  /// Scans whose numbers of rings are not those of the sensor, but can be mapped to its channels.
  size_t scans_with_rings_renumbered = 0;
  size_t scans_thinned = 0;  ///< Scans that lack so many points that gaps do not imply misses.
  std::map<std::string, size_t> skipped;  ///< Points left out, by reason.
};

/// Makes the beams of one scan and adds to `counts`.
///
/// - Ring: it is the file's own number, made the sensor's by `channels_of_rings`, if the numbers
///   distinguish rings (`rings_are_numbered`). An organised scan without one gives its row.
///   Otherwise rings are recovered from the file's order (KITTI: 0 = top), or, if that gives
///   another number of rings than the sensor has channels, from the elevation (index of the
///   channel; counted). Without a sensor, more than 256 recovered rings are not taken for rings,
///   and all are 0.
/// - Misses: points of an organised scan that are (0,0,0) or not finite are misses, and their
///   directions come from `find_organised_scan`. Where there is no grid they are skipped and
///   counted.
/// - Origin: it is the sensor's origin; heights of single lasers and Ouster's 12 mm are ignored.
///   With `deskew` it is taken at the beam's own time, else all beams share the scan's pose.
/// - Order: with `deskew` beams are sorted by time, then ring. Otherwise they are in the file's
///   order, and an inferred miss follows the return before its gap.
/// - Packet: beams are divided by firing time into bins of the sensor's `firings_per_packet`
///   firings, from 0 in each scan. Without per-point time the azimuth from the rear takes its
///   place, and without a sensor bins are 2° of azimuth.
/// - Intensity and extra columns: they are the file's, and 0 for an inferred miss, which is flagged
///   `kInferred`. Returns beyond the maximum range are kept.
///
/// Throws `std::invalid_argument` where columns differ in length or a sensor is not valid.
BeamLog beams_from_scan(const PointScan& scan, const Trajectory& trajectory,
                        const BeamOptions& options, BeamCounts& counts);

}  // namespace underbrush::sensor
