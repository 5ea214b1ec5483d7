/// \file
/// Rings and misses of scans whose format keeps neither (KITTI and its kin).
#pragma once
#include <cstddef>
#include <vector>

#include "underbrush/sensor/rays.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// Rings of points stored ring by ring with rising azimuth (mod 2π): a new ring starts where that
/// azimuth falls by more than π. One number per point, from 0. Points that are no return keep the
/// ring of the point before.
std::vector<uint16_t> rings_from_order(const std::vector<Vec3f>& points);

/// Rings by elevation: the channel whose beam, from its height z and raised by −`fault_rad`, comes
/// nearest to the point: elevation = e + asin(z cos(e) / r) − fault.
std::vector<uint16_t> rings_from_elevation(const std::vector<Vec3f>& points, const Sensor& sensor,
                                           double fault_rad);

/// What `insert_misses` did.
struct InsertedMisses {
  size_t inserted = 0;
  size_t unknown = 0;  ///< Not inserted: their ring points below `unknown_below_rad`.
};

/// Appends to `rays` the misses that the format dropped. Within a ring, neighbours (also across
/// azimuth 0) more than 1.8 steps apart have round(gap/step) − 1 misses between them, evenly
/// spaced, with elevation and time interpolated. The step is the scan's own: the median over rings
/// of the mean gap below 1.8 `nominal_step_rad`. A ring of `sensor` without any return is one whole
/// turn of misses at its catalogue elevation and `time_s`, provided that half of its rings have
/// some. Whether a ring is unknown is decided by its catalogue elevation, where `sensor` has its
/// rings in the same sense as the scan, else by the median elevation of its returns plus
/// `fault_rad`. `revolution_s` is used to tell a gap at the scan's own seam, where times jump.
InsertedMisses insert_misses(std::vector<SensorRay>& rays, const Sensor& sensor,
                             double nominal_step_rad, double unknown_below_rad, double fault_rad,
                             double revolution_s, double time_s);

}  // namespace underbrush::sensor
