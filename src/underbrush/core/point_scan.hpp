/// \file
/// One scan as most formats hold it: points in the sensor's frame, often without the misses.
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
  std::vector<Vec3f> point;      ///< m; (0,0,0) or NaN where an organised format holds a miss.
  std::vector<float> intensity;  ///< In the sensor's unit; as long as `point`.
  std::vector<double> time_s;    ///< Time of each point (s, absolute); empty where the format has
                                 ///< none.
  std::vector<uint16_t> ring;    ///< Channel of each point; empty where the format has none.
  std::map<std::string, ExtraColumn> extra;

  size_t size() const { return point.size(); }
};

/// Source of scans, as the readers of third-party folder formats provide it.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  /// Number of scans that will be read (after any selection of frames).
  virtual size_t size() const = 0;
  /// Reads scan `k` of `size()`. Its `info` carries number, time and pose. Throws `FormatError`.
  virtual PointScan read(size_t k) = 0;
  /// Returns the sensor's poses at all scans, also those not selected, for interpolation within a
  /// scan.
  virtual const Trajectory& trajectory() const = 0;
  /// Returns how many records were left out so far, by reason.
  virtual const std::map<std::string, size_t>& skipped() const = 0;
};

}  // namespace underbrush
