/// \file
/// Checks of beams whose file gives each its origin, for signs of wrong units and poses.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// Keeps some returns of the first 32 scans of a log, at most about 20 000 of each.
class BeamChecks {
 public:
  /// Takes the next beams of a log, of whose scans `info` has the poses.
  void add(const BeamLog& beams);

  /// Returns the warnings of `import_checks.hpp` about the first scan, that of the greatest range
  /// where there are no misses, and those of `pose_checks.hpp` about the scans with poses.
  std::vector<std::string> warnings() const;

 private:
  PointScan first_;                      ///< Points at their ranges from the sensor.
  std::map<uint32_t, PointScan> scans_;  ///< Points in the sensor's frame at the scan's time.
  double max_range_m_ = 0;
  bool has_misses_ = false;
};

}  // namespace underbrush::pipeline
