/// \file
/// Gaps in poses, in which the place of the sensor is not known.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::io {

/// A time without poses, s, in which the sensor moved.
struct PoseGap {
  double from_s = 0, to_s = 0;
  double moved_m = 0;
  bool has(double time_s) const { return time_s > from_s && time_s < to_s; }
};

/// Finds the gaps of poses in order of time: more than 1 s and ten usual steps without a pose, in
/// which the sensor moves by more than 0.5 m and three usual steps, or turns by more than 5° and
/// three usual turns. Poses are extrapolated by one step, and the gap is what remains; where a scan
/// of `reach_s` ends that begins before it, or begins that ends behind it, `poses` get another one.
std::vector<PoseGap> split_at_gaps(std::vector<StampedPose>& poses, double reach_s);

/// Returns the middle one of the ascending steps between neighbours; 0 if there is none.
double usual_step(const std::vector<double>& times);

}  // namespace underbrush::io
