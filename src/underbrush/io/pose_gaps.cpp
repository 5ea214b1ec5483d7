#include "underbrush/io/pose_gaps.hpp"

#include <algorithm>

#include "underbrush/core/median.hpp"

namespace underbrush::io {
namespace {

/// The pose at `time_s`, by the motion between two poses before or after it.
StampedPose extrapolated(const StampedPose& a, const StampedPose& b, double time_s) {
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  return {time_s, interpolate(a.world_from_sensor, b.world_from_sensor, share)};
}

}  // namespace

double usual_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  }
  return median(std::move(steps));
}

std::vector<PoseGap> split_at_gaps(std::vector<StampedPose>& poses, double reach_s) {
  constexpr double kLong = 1, kSteps = 10, kFar = 0.5, kTurned = 5 * kDegree, kUsual = 3;
  if (poses.size() < 3) return {};
  std::vector<double> step, way, turn;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Pose &a = poses[i - 1].world_from_sensor, &b = poses[i].world_from_sensor;
    step.push_back(poses[i].time_s - poses[i - 1].time_s);
    way.push_back((b.translation - a.translation).norm());
    turn.push_back(a.rotation.angularDistance(b.rotation));
  }
  const double usual = median(step), far = std::max(kFar, kUsual * median(way)),
               turned = std::max(kTurned, kUsual * median(turn)), reach = std::max(reach_s, usual);
  std::vector<PoseGap> gaps;
  std::vector<StampedPose> out{poses[0]};
  size_t begin = 0;  // of the poses since the last gap
  for (size_t i = 1; i < poses.size(); ++i) {
    const double from = poses[i - 1].time_s, to = poses[i].time_s;
    const bool gap = to - from > std::max({kLong, kSteps * usual, 2 * usual + 2.5 * reach}) &&
                     (way[i - 1] > far || turn[i - 1] > turned);
    if (gap) {
      size_t before = i - 1, after = i;
      while (before > begin && poses[before].time_s > from - reach) --before;
      while (after + 1 < poses.size() && poses[after].time_s < to + reach) ++after;
      const double first = from + usual, last = to - usual;  // of the gap
      if (before < i - 1) out.push_back(extrapolated(poses[before], poses[i - 1], first + reach));
      if (after > i) out.push_back(extrapolated(poses[i], poses[after], last - reach));
      gaps.push_back({first, last, way[i - 1]});
      begin = i;
    }
    out.push_back(poses[i]);
  }
  poses = std::move(out);
  return gaps;
}

}  // namespace underbrush::io
