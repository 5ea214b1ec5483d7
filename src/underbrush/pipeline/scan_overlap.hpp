/// \file
/// How much of a scan lies where an earlier one has points, and with which motion of the sensor
/// most of it does.
#pragma once
#include <cstddef>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// Returns points of a scan, m in its frame turned by `upright`: about `most` of those within 2 to
/// 40 m that lie 0.3 m above the median height in both frames and have another 0.3 m above or below
/// them. Points on flat ground overlap with any motion, and circles on a flat ceiling do best
/// without any.
std::vector<Vec3> upper_points(const PointScan& scan, const Eigen::Quaterniond& upright,
                               size_t most);

/// The cells (0.4 m) within 40 m of a sensor that hold points of its scan.
class ScanCells {
 public:
  explicit ScanCells(const std::vector<Vec3>& points);

  /// Returns the share of points that lie in these cells, once the pose moves them to this sensor's
  /// frame; 0 where there are none.
  double share_of(const std::vector<Vec3>& points, const Pose& this_from_points) const;
  /// Returns the share of points that lie in these cells, of points whose cells have the sums of
  /// two numbers; a sum below 0 is beyond the cells.
  double share_of(const std::vector<int>& some, const std::vector<int>& rest) const;

 private:
  std::vector<bool> filled_;
};

/// A motion from one scan to a later one.
struct ScanMotion {
  Pose pose;         ///< Earlier sensor from later sensor.
  double share = 0;  ///< The share of the later scan's points in cells of the earlier one.
};

/// Returns the level motion with the largest share, of those by up to 4 m forward and to the side
/// in steps of 0.4 m and by up to 10° about the upward axis in steps of 1°.
ScanMotion best_motion(const ScanCells& earlier, const std::vector<Vec3>& later);

}  // namespace underbrush::pipeline
