/// \file
/// The rays of one raw scan in the sensor's frame: what a point cloud says before poses come in.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::sensor {

/// What a stored point stands for.
enum class PointKind : uint8_t { kReturn, kNothing, kTooNear };

/// A return, or `kNothing` for the (0,0,0) or non-finite of an organised format's miss, or
/// `kTooNear` for a range below `min_range_m`.
inline PointKind kind_of(const Vec3f& p, double min_range_m) {
  if (!p.allFinite() || p.isZero(0)) return PointKind::kNothing;
  return p.cast<double>().norm() < min_range_m ? PointKind::kTooNear : PointKind::kReturn;
}

/// A beam in the sensor's frame; angles as the format has them, no fault corrected.
struct SensorRay {
  static constexpr uint32_t kInserted = UINT32_MAX;

  uint32_t source = kInserted;  ///< Index in the scan, or `kInserted`.
  uint32_t place = 0;           ///< Order in the file: the index of the point itself or before it.
  uint16_t ring = 0;
  PointKind kind = PointKind::kNothing;
  double azimuth_rad = 0;  ///< Counter-clockwise from forward.
  double elevation_rad = 0;
  double time_s = 0;  ///< Absolute.
};

/// Azimuth (rad, counter-clockwise from x) of a point seen from the origin.
inline double azimuth_of(const Vec3f& p) { return std::atan2(double(p.y()), double(p.x())); }
/// Elevation (rad, above the xy plane) of a point seen from the origin.
inline double elevation_of(const Vec3f& p) {
  return std::atan2(double(p.z()), std::hypot(double(p.x()), double(p.y())));
}

/// The median of `values` (the upper one of two); 0 if there are none. Reorders them.
inline double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace underbrush::sensor
