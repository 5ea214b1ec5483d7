#include "underbrush/actors/track.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

#include "underbrush/core/median.hpp"

namespace underbrush::actors {
namespace {

using perception::OrientedBox;
using perception::SeenBox;

Vec3 median_size(const std::vector<SeenBox>& boxes) {
  Vec3 out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> sizes;
    sizes.reserve(boxes.size());
    for (const SeenBox& s : boxes) sizes.push_back(s.object.box.size_m[axis]);
    out[axis] = median(std::move(sizes));
  }
  return out;
}

/// The class of most boxes; of equals the first.
perception::ObjectClass usual_class(const std::vector<SeenBox>& boxes) {
  std::array<size_t, perception::kClassCount> count{};
  for (const SeenBox& s : boxes) ++count[size_t(s.object.label)];
  return perception::ObjectClass(std::ranges::max_element(count) - count.begin());
}

/// How far (m) a point of the frame of a box lies outside of it; negative inside.
double outside_m(const Vec3& in_box, const Vec3& size_m) {
  return (in_box.cwiseAbs() - size_m / 2).maxCoeff();
}

/// Whether a ray enters a box before `range_m`, by the method of slabs.
bool enters(const OrientedBox& box, double margin_m, const Ray& ray, double range_m) {
  const Vec3 o = box.to_box(ray.origin);
  const Vec3 d = OrientedBox{Vec3::Zero(), box.yaw_rad, {}}.to_box(ray.direction);
  double enter = 0, leave = range_m;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double half = box.size_m[axis] / 2 + margin_m;
    if (std::abs(d[axis]) < 1e-12) {
      if (std::abs(o[axis]) > half) return false;
      continue;
    }
    const double a = (-half - o[axis]) / d[axis], b = (half - o[axis]) / d[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

/// The median time between boxes, s.
double usual_gap_s(const std::vector<SeenBox>& seen) {
  constexpr double kOfOneBox = 0.1;
  std::vector<double> gaps;
  for (size_t k = 1; k < seen.size(); ++k) gaps.push_back(seen[k].time_s - seen[k - 1].time_s);
  return median(std::move(gaps), kOfOneBox);
}

uint32_t scan_at(double time_s, const LogInfo& log) {
  const auto nearer = [&](const ScanInfo& a, const ScanInfo& b) {
    return std::abs(a.time_s - time_s) < std::abs(b.time_s - time_s);
  };
  const auto at = std::ranges::min_element(log.scans, nearer);
  return at == log.scans.end() ? 0 : at->scan;
}

}  // namespace

std::string Track::name() const {
  return std::string(perception::name(label)) + "-" + std::to_string(id);
}

std::vector<Track> tracks_of(std::span<const SeenBox> boxes) {
  std::map<uint64_t, Track> tracks;
  for (const SeenBox& s : boxes) {
    Track& t = tracks[s.object.id];
    t.id = s.object.id;
    t.seen.push_back(s);
  }
  std::vector<Track> out;
  for (auto& [id, track] : tracks) {
    std::ranges::stable_sort(track.seen, {}, &SeenBox::time_s);
    const auto same_time = [](const SeenBox& a, const SeenBox& b) { return a.time_s == b.time_s; };
    track.seen.erase(std::unique(track.seen.begin(), track.seen.end(), same_time),
                     track.seen.end());
    track.size_m = median_size(track.seen);
    track.label = usual_class(track.seen);
    for (SeenBox& s : track.seen) s.object.box.size_m = track.size_m;
    out.push_back(std::move(track));
  }
  return out;
}

std::vector<SeenBox> boxes_of(std::span<const perception::ObjectList> lists, const LogInfo& log) {
  const auto is_measured = [](const perception::TrackedObject& o) { return o.is_measured; };
  const bool some_measured = std::ranges::any_of(lists, [&](const perception::ObjectList& list) {
    return std::ranges::any_of(list.objects, is_measured);
  });
  std::vector<SeenBox> out;
  std::map<uint64_t, double> heading;
  for (const perception::ObjectList& list : lists) {
    const uint32_t scan = scan_at(list.time_s, log);
    for (const perception::TrackedObject& o : list.objects) {
      if (some_measured && !o.is_measured) continue;
      SeenBox seen{scan, list.time_s, {o.id, o.label, o.box}};
      double& yaw = seen.object.box.yaw_rad;
      const auto before = heading.find(o.id);
      if (before != heading.end() &&
          std::abs(perception::wrapped(yaw - before->second)) > M_PI / 2) {
        yaw = perception::wrapped(yaw + M_PI);
      }
      heading[o.id] = yaw;
      out.push_back(seen);
    }
  }
  return out;
}

BoxesOfBeams::BoxesOfBeams(const std::vector<Track>& tracks, const BoxOptions& options)
    : tracks_(tracks), options_(options) {
  for (const Track& t : tracks) usual_gap_s_.push_back(usual_gap_s(t.seen));
}

std::optional<OrientedBox> BoxesOfBeams::box(size_t track, double time_s) const {
  const std::vector<SeenBox>& seen = tracks_[track].seen;
  const auto after = std::ranges::upper_bound(seen, time_s, {}, &SeenBox::time_s);
  double off_s = HUGE_VAL;
  if (after != seen.end()) off_s = after->time_s - time_s;
  if (after != seen.begin()) off_s = std::min(off_s, time_s - std::prev(after)->time_s);
  if (off_s > 0.75 * usual_gap_s_[track]) return {};
  if (seen.size() < 2) return seen[0].object.box;
  const size_t k = std::clamp<size_t>(size_t(after - seen.begin()), 1, seen.size() - 1);
  const OrientedBox &a = seen[k - 1].object.box, &b = seen[k].object.box;
  const double s = (time_s - seen[k - 1].time_s) / (seen[k].time_s - seen[k - 1].time_s);
  return OrientedBox{a.centre_m + s * (b.centre_m - a.centre_m),
                     a.yaw_rad + s * perception::wrapped(b.yaw_rad - a.yaw_rad), a.size_m};
}

void BoxesOfBeams::look_at(double time_s) {
  if (time_s == time_s_) return;
  time_s_ = time_s;
  now_.clear();
  for (size_t t = 0; t < tracks_.size(); ++t) {
    if (const auto here = box(t, time_s)) now_.emplace_back(t, *here);
  }
}

std::optional<size_t> BoxesOfBeams::track_of_return(const BeamLog& log, size_t i) {
  if (!log.is_hit(i)) return {};
  look_at(log.time_s[i]);
  const Vec3 end = log.end_point(i);
  std::optional<size_t> best;
  double least = options_.margin_m;
  for (const auto& [track, box] : now_) {
    const Vec3 p = box.to_box(end);
    if (p.z() < options_.foot_m - box.size_m.z() / 2) continue;
    const double outside = outside_m(p, box.size_m);
    if (outside > least) continue;
    least = outside;
    best = track;
  }
  return best;
}

void BoxesOfBeams::tracks_on(const BeamLog& log, size_t i, std::vector<size_t>& tracks) {
  tracks.clear();
  look_at(log.time_s[i]);
  if (now_.empty()) return;
  const double range_m = log.is_hit(i) ? double(log.range_m[i]) : log.info.max_range_m;
  const Ray ray = log.ray(i);
  for (const auto& [track, box] : now_) {
    if (enters(box, options_.margin_m, ray, range_m)) tracks.push_back(track);
  }
}

}  // namespace underbrush::actors
