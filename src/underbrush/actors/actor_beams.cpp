#include "underbrush/actors/actor_beams.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/median.hpp"

namespace underbrush::actors {
namespace {

using perception::OrientedBox;

Pose pose_of(const OrientedBox& box) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(box.yaw_rad, Vec3::UnitZ())), box.centre_m};
}

/// Adds a beam to the view of a box.
void add(const BeamLog& log, size_t i, bool is_return, View& view) {
  if (view.beams.empty()) {
    view.beams = log.like();
    view.beams.info.scans.clear();
  }
  view.beams.append(log, i);
  view.beams.flags.back() &= uint8_t(~kMover);  // A fit leaves out returns that have the mark.
  if (is_return) {
    ++view.returns;
    view.time_s += log.time_s[i];
  } else {
    view.beams.range_m.back() = kMiss;
  }
}

/// Half the median time between views, s.
double half_gap_s(const std::vector<StampedPose>& poses) {
  std::vector<double> gaps;
  for (size_t k = 1; k < poses.size(); ++k) gaps.push_back(poses[k].time_s - poses[k - 1].time_s);
  return median(std::move(gaps)) / 2;
}

}  // namespace

std::vector<std::vector<View>> views_of(BeamSource& log, const std::vector<Track>& tracks,
                                        const BoxOptions& options) {
  BoxesOfBeams boxes(tracks, options);
  std::vector<std::map<uint32_t, View>> all(tracks.size());
  std::vector<size_t> met;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto end = boxes.track_of_return(chunk, i);
      boxes.tracks_on(chunk, i, met);
      if (end && std::ranges::find(met, *end) == met.end()) met.push_back(*end);
      for (const size_t track : met) add(chunk, i, track == end, all[track][chunk.scan[i]]);
    }
  }
  std::vector<std::vector<View>> out(tracks.size());
  for (size_t t = 0; t < tracks.size(); ++t) {
    for (auto& [scan, view] : all[t]) {
      if (view.returns == 0) continue;
      view.time_s /= double(view.returns);
      const auto box = boxes.box(t, view.time_s);
      if (!box) continue;
      view.world_from_actor = pose_of(*box);
      out[t].push_back(std::move(view));
    }
    std::ranges::sort(out[t], {}, &View::time_s);
    require_data(std::ranges::adjacent_find(out[t], {}, &View::time_s) == out[t].end(),
                 "actors: two scans share one time");
  }
  return out;
}

Trajectory trajectory_of(const std::vector<View>& views) {
  std::vector<StampedPose> poses;
  poses.reserve(views.size() + 2);
  for (const View& v : views) poses.push_back({v.time_s, v.world_from_actor});
  const Trajectory known(poses);
  const double more_s = half_gap_s(poses);
  for (const double time_s : {poses.front().time_s - more_s, poses.back().time_s + more_s}) {
    if (const auto pose = known.at(time_s)) poses.push_back({time_s, *pose});
  }
  return Trajectory(poses);
}

BeamLog in_actor_frame(const std::vector<View>& views, const Trajectory& world_from_actor) {
  BeamLog out;
  for (const View& v : views) {
    if (out.empty()) out = v.beams.like();
    for (size_t i = 0; i < v.beams.size(); ++i) {
      out.append(v.beams, i);
      const Pose pose =
          world_from_actor.at(v.beams.time_s[i]).value_or(v.world_from_actor).inverse();
      out.origin.back() = pose * v.beams.origin[i];
      out.direction.back() =
          (pose.rotation * v.beams.direction[i].cast<double>()).normalized().cast<float>();
    }
  }
  return out;
}

}  // namespace underbrush::actors
