#include "studies/moving_objects.hpp"

#include <algorithm>
#include <map>

#include "studies/car_mesh.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::studies {
namespace {

using perception::OrientedBox;
using perception::SeenBox;

constexpr double kMarginM = 0.4;       // Labels are that coarse.
constexpr size_t kLeastPoints = 30;    // Of an object that ellipsoids are fitted to.
constexpr double kTightMarginM = 0.1;  // Of a box around an object's own points.

bool holds(const OrientedBox& box, const Vec3& p, double margin_m) {
  const Vec3 q = box.to_box(p), half = box.size_m / 2;
  return std::abs(q.x()) <= half.x() + margin_m && std::abs(q.y()) <= half.y() + margin_m &&
         std::abs(q.z()) <= half.z() + margin_m;
}

/// The boxes of each scan.
std::map<uint32_t, std::vector<const SeenBox*>> by_scan(const std::vector<ObjectTrack>& tracks) {
  std::map<uint32_t, std::vector<const SeenBox*>> out;
  for (const ObjectTrack& t : tracks) {
    for (const SeenBox& s : t.seen) out[s.scan].push_back(&s);
  }
  return out;
}

// Whether a ray enters a box before `range`, by the method of slabs.
bool crosses(const OrientedBox& box, const Vec3& origin, const Vec3& direction, double range) {
  const Vec3 o = box.to_box(origin);
  const Vec3 d = OrientedBox{Vec3::Zero(), box.yaw_rad, {}}.to_box(direction);
  double enter = 0, leave = range;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = box.size_m[axis] / 2 + kTightMarginM;
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

// The beam in the frame of the box. One that ends behind the object has passed through it.
void add_beam(const BeamLog& from, size_t i, const OrientedBox& box, BeamLog& to) {
  to.append(from, i);
  const size_t k = to.size() - 1;
  to.origin[k] = box.to_box(from.origin[i]);
  const Vec3 d = from.direction[i].cast<double>();
  to.direction[k] = OrientedBox{Vec3::Zero(), box.yaw_rad, {}}.to_box(d).cast<float>();
  if (!from.is_hit(i) || !holds(box, from.end_point(i), kTightMarginM)) to.range_m[k] = kMiss;
}

size_t hits_of(const BeamLog& log) {
  size_t n = 0;
  for (size_t i = 0; i < log.size(); ++i) n += log.is_hit(i);
  return n;
}

}  // namespace

std::vector<ObjectTrack> tracks_of(const perception::LogTruth& truth) {
  std::map<uint64_t, ObjectTrack> tracks;
  for (const SeenBox& s : truth.seen()) {
    ObjectTrack& t = tracks[s.object.id];
    t.id = s.object.id;
    t.label = s.object.label;
    t.size_m = s.object.box.size_m;
    t.seen.push_back(s);
  }
  std::vector<ObjectTrack> out;
  for (auto& [id, track] : tracks) {
    std::sort(track.seen.begin(), track.seen.end(),
              [](const SeenBox& a, const SeenBox& b) { return a.time_s < b.time_s; });
    out.push_back(std::move(track));
  }
  return out;
}

StaticBeams::StaticBeams(BeamSource& log, const std::vector<ObjectTrack>& tracks,
                         uint32_t every_nth)
    : log_(log), tracks_(tracks), every_nth_(every_nth) {}

bool StaticBeams::next(BeamLog& chunk) {
  const auto boxes = by_scan(tracks_);
  BeamLog all;
  if (!log_.next(all)) {
    chunk = BeamLog();
    return false;
  }
  chunk = all.like();
  for (size_t i = 0; i < all.size(); ++i) {
    if (all.scan[i] % every_nth_ != 0) continue;
    const auto here = boxes.find(all.scan[i]);
    const Vec3 end = all.end_point(i);
    const bool is_object =
        here != boxes.end() && all.is_hit(i) &&
        std::any_of(here->second.begin(), here->second.end(),
                    [&](const SeenBox* s) { return holds(s->object.box, end, kMarginM); });
    if (!is_object) chunk.append(all, i);
  }
  return true;
}

std::vector<elements::Model> models_of_points(BeamSource& log,
                                              const std::vector<ObjectTrack>& tracks,
                                              uint64_t seed) {
  const auto boxes = by_scan(tracks);
  std::map<uint64_t, BeamLog> own;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto here = boxes.find(chunk.scan[i]);
      if (chunk.scan[i] % 2 != 0 || here == boxes.end()) continue;
      const double range = chunk.is_hit(i) ? double(chunk.range_m[i]) : chunk.info.max_range_m;
      const Vec3 direction = chunk.direction[i].cast<double>();
      for (const SeenBox* s : here->second) {
        if (!crosses(s->object.box, chunk.origin[i], direction, range)) continue;
        BeamLog& beams = own[s->object.id];
        if (beams.empty()) beams = chunk.like();
        add_beam(chunk, i, s->object.box, beams);
      }
    }
  }
  std::vector<elements::Model> models = meshes_of(tracks);
  for (size_t k = 0; k < tracks.size(); ++k) {
    const BeamLog& beams = own[tracks[k].id];
    if (hits_of(beams) < kLeastPoints) continue;
    fit::FitOptions options;
    options.seed = seed;
    options.segment.method = "none";
    MemorySource source(beams);
    models[k] = pipeline::fit_model({source}, options).model;
    models[k].max_range_m = std::numeric_limits<double>::infinity();
  }
  return models;
}

std::vector<elements::Model> meshes_of(const std::vector<ObjectTrack>& tracks) {
  std::vector<elements::Model> models;
  models.reserve(tracks.size());
  for (const ObjectTrack& t : tracks) models.push_back(road_user(t.label, t.size_m));
  return models;
}

}  // namespace underbrush::studies
