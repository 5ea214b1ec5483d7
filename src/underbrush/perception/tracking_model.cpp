#include "underbrush/perception/tracking_model.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

void TrackingOptions::check() const {
  resolution.check();
  shape.check();
  track.check();
  require(latency_s >= 0, "tracking: the latency must not be negative");
}

void to_world(const MergedCloud& cloud, std::vector<Vec3>& points) {
  const Mat3 turn = cloud.world_from_vehicle.rotation.toRotationMatrix();
  const Vec3& shift = cloud.world_from_vehicle.translation;
  points.resize(cloud.size());
  for (size_t i = 0; i < points.size(); ++i) {
    points[i].noalias() = turn * cloud.point_m[i].cast<double>();
    points[i] += shift;
  }
}

Vec3 viewpoint_of(const MergedCloud& cloud) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3f& s : cloud.sensor_m) sum += s.cast<double>();
  if (!cloud.sensor_m.empty()) sum /= double(cloud.sensor_m.size());
  return cloud.world_from_vehicle * sum;
}

TrackingModel::TrackingModel(const TrackingOptions& options)
    : options_(options),
      assignment_(options.assignment),
      resolution_(options.resolution),
      shapes_(options.shape) {
  options_.check();
}

void TrackingModel::reset() { *this = TrackingModel(options_); }

Track* TrackingModel::find(uint64_t truth_id) {
  const auto at = std::lower_bound(tracks_.begin(), tracks_.end(), truth_id,
                                   [](const Track& t, uint64_t id) { return t.truth_id < id; });
  return at != tracks_.end() && at->truth_id == truth_id ? &*at : nullptr;
}

Track& TrackingModel::begin_track(const TruthObject& object) {
  const auto at = std::lower_bound(tracks_.begin(), tracks_.end(), object.id,
                                   [](const Track& t, uint64_t id) { return t.truth_id < id; });
  Track track;
  track.id = next_id_++;
  track.truth_id = object.id;
  track.label = object.label;
  track.probability[size_t(object.label)] = 1;
  track.last_s = time_s_;
  return *tracks_.insert(at, track);
}

void TrackingModel::make_segments(const MergedCloud& cloud, const TruthFrame& truth) {
  ids_.clear();
  listed_.clear();
  for (const TruthObject& o : truth.objects) {
    require(o.id != 0, "tracking: an object of the truth has the number 0");
    ids_.push_back(o.id);
    const Track* track = find(o.id);
    listed_.push_back(track && track->existence.is_listed());
  }
  to_world(cloud, points_);
  assignment_.assign(points_, truth.objects, segments_);
  segments_.gather(points_, truth.objects.size());
  if (resolution_.merge(ids_, listed_, viewpoint_, segments_)) {
    segments_.gather(points_, truth.objects.size());
  }
  std::sort(ids_.begin(), ids_.end());
  require(std::adjacent_find(ids_.begin(), ids_.end()) == ids_.end(),
          "tracking: two objects of the truth have the same number");
}

void TrackingModel::update(const TruthObject& object, size_t segment) {
  const auto points = segments_.points(segment);
  Track* track = find(object.id);
  if (!track) {
    if (points.empty()) return;
    track = &begin_track(object);
  }
  track->label = object.label;
  double extent_m = 0;
  if (!points.empty()) {
    std::optional<double> heading = object.box.yaw_rad;
    if (options_.heading == HeadingSource::kPoints) {
      heading = shapes_.heading(points, viewpoint_);
      if (heading) heading = nearest_quarter(*heading, object.box.yaw_rad);
    }
    const double yaw = heading.value_or(object.box.yaw_rad);
    const SegmentShape shape = ShapeFitter::measure(points, yaw, viewpoint_);
    extent_m = shape.extent_m();
    track->measure(options_.track, shape, yaw, yaw);
  }
  track->existence.update(options_.track.existence, track->label, uint32_t(points.size()),
                          extent_m);
}

void TrackingModel::step(const MergedCloud& cloud, const TruthFrame& truth, ObjectList& list) {
  time_s_ = std::max(time_s_, cloud.time_s);
  if (tracks_.empty()) time_s_ = cloud.time_s;
  viewpoint_ = viewpoint_of(cloud);
  make_segments(cloud, truth);
  for (Track& t : tracks_) t.predict(options_.track, time_s_);
  for (size_t k = 0; k < truth.objects.size(); ++k) update(truth.objects[k], k);
  // An object that the truth no longer has is one without points.
  for (Track& t : tracks_) {
    if (std::binary_search(ids_.begin(), ids_.end(), t.truth_id)) continue;
    t.existence.update(options_.track.existence, t.label, 0, 0);
  }
  std::erase_if(tracks_,
                [&](const Track& t) { return t.existence.is_gone(options_.track.existence); });
  write(cloud, list);
}

void TrackingModel::write(const MergedCloud& cloud, ObjectList& list) const {
  list.time_s = time_s_;
  list.available_s = std::max(cloud.available_s, time_s_) + options_.latency_s;
  list.world_from_vehicle = cloud.world_from_vehicle;
  list.objects.clear();
  for (const Track& t : tracks_) {
    if (t.existence.is_listed()) list.objects.push_back(t.reported());
  }
  std::sort(list.objects.begin(), list.objects.end(),
            [](const TrackedObject& a, const TrackedObject& b) { return a.id < b.id; });
}

}  // namespace underbrush::perception
