/// \file
/// One scan as most formats hold it: points in the sensor's frame, the misses often lost.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush {

/// One revolution or frame in the sensor's frame (x forward, y left, z up, m), in the file's order.
struct PointScan {
  ScanInfo info;
  std::vector<Vec3f> point;      ///< (0,0,0) or NaN where an organised format holds a miss.
  std::vector<float> intensity;  ///< Sensor units; as long as `point`.
  std::vector<double> time_s;    ///< Per point, absolute; empty where the format has none.
  std::vector<uint16_t> ring;    ///< Per point; empty where the format has none.
  std::map<std::string, ExtraColumn> extra;

  size_t size() const { return point.size(); }
};

/// A log as a sequence of scans: what the readers of others' folder formats give.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  /// Number of scans that will be read (after any selection of frames).
  virtual size_t size() const = 0;
  /// Reads scan `k` of `size()`; its `info` carries number, time and pose. Throws `FormatError`.
  virtual PointScan read(size_t k) = 0;
  /// All scan poses over time, also of frames not selected, for interpolation within a scan.
  virtual const Trajectory& trajectory() const = 0;
  /// Records left out so far, by reason.
  virtual const std::map<std::string, size_t>& skipped() const = 0;
};

}  // namespace underbrush
