/// \file
/// The motion that a motion-compensated scan carries in its points.
#pragma once
#include <array>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::sensor {

/// The motion of the beams' frame over a scan in the frame of its points: a point measured in the
/// beams' frame at share u ∈ [0, 1] of the scan lies at R(u) · point + T(u). R(u) is the rotation
/// by a vector that is piecewise linear in u, T(u) is linear. The default is no motion.
class ScanMotion {
 public:
  /// A point of the scan and the direction that the layout of the scan expects for it.
  struct Sample {
    double share = 0;  ///< u, from 0 to 1.
    Vec3 point;        ///< m, in the frame of the points.
    Vec3 direction;    ///< Unit vector, in the beams' frame.
  };

  ScanMotion() { turn_rad_.fill(Vec3::Zero()); }

  /// Returns a direction (a miss has no range) of the beams' frame in the frame of the points.
  Vec3 direction_of_points(double share, const Vec3& direction) const;
  /// Returns a point in the beams' frame.
  Vec3 point_of_beams(double share, const Vec3& point) const;

  /// Improves the motion by one step of least squares on the angles between the samples' points and
  /// directions, without the samples that lie off by more than four times the median angle.
  void improve(const std::vector<Sample>& samples);

 private:
  static constexpr int kKnots = 9;
  static constexpr int kUnknowns = 3 * kKnots + 6;

  Eigen::Quaterniond rotation(double share) const;
  Vec3 translation(double share) const { return start_ + share * (end_ - start_); }

  std::array<Vec3, kKnots> turn_rad_;
  Vec3 start_ = Vec3::Zero(), end_ = Vec3::Zero();  // m
};

}  // namespace underbrush::sensor
