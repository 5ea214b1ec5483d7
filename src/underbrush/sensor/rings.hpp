/// \file
/// This file recovers rings and misses of scans whose format keeps neither, such as KITTI's.
#pragma once
#include <cstddef>
#include <vector>

#include "underbrush/sensor/rays.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// Recovers the rings of points that are stored ring by ring with rising azimuth (mod 2π). A new
/// ring starts where the azimuth falls by more than π. The result has one number for each point,
/// from 0; points that are no return take the ring of the point before.
std::vector<uint16_t> rings_from_order(const std::vector<Vec3f>& points);

/// Assigns points to rings by elevation: the ring is the channel whose beam, from its height z,
/// comes nearest to the point, elevation = e + asin(z cos(e) / r) − fault.
std::vector<uint16_t> rings_from_elevation(const std::vector<Vec3f>& points, const Sensor& sensor,
                                           double fault_rad);

/// Counts of `insert_misses`.
struct InsertedMisses {
  size_t inserted = 0;
  size_t unknown = 0;  ///< Beams left out because they may have been no misses.
  /// Whether more than 40 % of neighbours in rings are farther apart than a step, as where points
  /// were left out of the scan.
  bool thinned = false;
};

/// Appends to `rays` the misses that the format dropped.
///
/// Within a ring, neighbours (also across azimuth 0) that are more than 1.8 steps apart get
/// round(gap/step) − 1 misses between them, evenly spaced, with interpolated elevation and time.
/// The step is the scan's own: the median over rings of the mean gap below 1.8 `nominal_step_rad`,
/// or the usual gap where that is larger and 60 % of all gaps are within 15 % of it.
/// A ring of `sensor` without any return becomes a whole turn of misses at its catalogue elevation
/// and `time_s`, provided that at least half of the sensor's rings have returns. It is unknown
/// where the nearest rings with returns have them in more than half of the turn, unless it lies
/// above the horizon and above all of them: only rings at the edge to the sky miss everything.
///
/// A beam below `unknown_below_rad` is unknown. The elevation is that of the ring: the one of the
/// catalogue if `sensor` numbers its rings in the same direction as the scan, else the median
/// elevation of the ring's returns plus `fault_rad`. `up` is the world's up in the sensor's frame.
/// Where it is more than 45° from the sensor's z, each beam has its own elevation in the world.
/// `revolution_s` serves to recognise a gap at the scan's own seam, where times jump.
InsertedMisses insert_misses(std::vector<SensorRay>& rays, const Sensor& sensor,
                             double nominal_step_rad, double unknown_below_rad, const Vec3& up,
                             double fault_rad, double revolution_s, double time_s);

}  // namespace underbrush::sensor
