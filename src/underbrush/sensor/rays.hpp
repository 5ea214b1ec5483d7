/// \file
/// This file has the rays of a raw scan in the sensor's frame, before poses are applied.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "underbrush/core/median.hpp"
#include "underbrush/core/point_scan.hpp"

namespace underbrush::sensor {

/// The meaning of a stored point.
enum class PointKind : uint8_t { kReturn, kNothing, kTooNear };

/// Returns the meaning of a point: `kNothing` for a point that is (0,0,0) or not finite, which
/// organised formats store for a miss; `kTooNear` for a range below `min_range_m`; else `kReturn`.
inline PointKind kind_of(const Vec3f& p, double min_range_m) {
  if (!p.allFinite() || p.isZero(0)) return PointKind::kNothing;
  return p.cast<double>().norm() < min_range_m ? PointKind::kTooNear : PointKind::kReturn;
}

/// A beam in the sensor's frame. Its angles are those of the format, without correction of faults.
struct SensorRay {
  static constexpr uint32_t kInserted = UINT32_MAX;

  uint32_t source = kInserted;  ///< Index in the scan, or `kInserted`.
  /// Order in the file: the index of the point itself, or of the point before it.
  uint32_t place = 0;
  uint16_t ring = 0;
  PointKind kind = PointKind::kNothing;
  double azimuth_rad = 0;  ///< Counter-clockwise from forward.
  double elevation_rad = 0;
  double time_s = 0;  ///< Absolute time, s.
};

/// Computes the azimuth of a point seen from the origin, rad, counter-clockwise from x.
inline double azimuth_of(const Vec3f& p) { return std::atan2(double(p.y()), double(p.x())); }
/// Computes the elevation of a point seen from the origin, rad, above the x–y plane.
inline double elevation_of(const Vec3f& p) {
  return std::atan2(double(p.z()), std::hypot(double(p.x()), double(p.y())));
}

}  // namespace underbrush::sensor
