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
/// three usual turns. The poses beside a gap are extrapolated into it by `reach_s` (at least a usual
/// step), as far as a scan needs them that began before it; the gap is what remains.
std::vector<PoseGap> split_at_gaps(std::vector<StampedPose>& poses, double reach_s);

/// Returns the middle one of the ascending steps between neighbours; 0 if there is none.
double usual_step(const std::vector<double>& times);

}  // namespace underbrush::io
