#include "underbrush/perception/object_pipeline.hpp"

#include <algorithm>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::perception {
namespace {

constexpr double kWidestM = 2.3;   // A longer extent is a length.
constexpr double kClearlyM = 0.5;  // By so much the other extent must be shorter.

}  // namespace

void PipelineOptions::check() const {
  clusters.check();
  shape.check();
  classification.check();
  track.check();
  require(gate_m > 0 && most_gate_m >= gate_m && latency_s >= 0,
          "pipeline: gates must be positive, and the latency not negative");
}

ObjectPipeline::ObjectPipeline(const PipelineOptions& options)
    : options_(options),
      clusters_(options.clusters),
      shapes_(options.shape),
      classification_(options.classification, options.track.completion) {
  options_.check();
}

void ObjectPipeline::reset() { *this = ObjectPipeline(options_); }

void ObjectPipeline::find_candidates(const MergedCloud& cloud) {
  to_world(cloud, points_);
  clusters_.find(cloud, points_, segments_);
  candidates_.clear();
  for (size_t k = 0; k < segments_.size(); ++k) candidates_.push_back(measured(k));
  if (!join_parts()) return;
  segments_.gather(points_, candidates_.size());
  for (size_t k = 0; k < segments_.size(); ++k) {
    if (has_parts_[k]) candidates_[k] = measured(k);
  }
}

// The roof, the mirrors and the sides of a vehicle may be seen apart.
bool ObjectPipeline::join_parts() {
  constexpr uint32_t kWhole = kNoSegment;
  const size_t count = candidates_.size();
  whole_.assign(count, kWhole);
  for (uint32_t part = 0; part < count; ++part) {
    const SegmentShape& p = candidates_[part].shape;
    for (uint32_t k = 0; k < count; ++k) {
      const SegmentShape& s = candidates_[k].shape;
      const bool is_larger = s.points > p.points || (s.points == p.points && k < part);
      if (!candidates_[k].heading_rad || !is_larger) continue;
      const Vec3 at = s.box.to_box(p.box.centre_m);
      if ((at.head<2>().cwiseAbs().array() > s.box.size_m.head<2>().array() / 2).any()) continue;
      if (whole_[part] == kWhole || s.points > candidates_[whole_[part]].shape.points) {
        whole_[part] = k;
      }
    }
  }
  number_.resize(count);
  uint32_t next = 0;
  for (uint32_t k = 0; k < count; ++k) {
    number_[k] = next;
    if (whole_[k] == kWhole) candidates_[next++] = candidates_[k];
  }
  if (next == count) return false;
  has_parts_.assign(next, 0);
  for (uint32_t& segment : segments_.of_point) {
    if (segment == kNoSegment) continue;
    const bool is_part = whole_[segment] != kWhole;
    while (whole_[segment] != kWhole) segment = whole_[segment];
    segment = number_[segment];
    if (is_part) has_parts_[segment] = 1;
  }
  candidates_.resize(next);
  return true;
}

ObjectPipeline::Candidate ObjectPipeline::measured(size_t segment) {
  const auto points = segments_.points(segment);
  Candidate c;
  c.heading_rad = shapes_.heading(points, viewpoint_);
  c.shape = ShapeFitter::measure(points, c.heading_rad.value_or(vehicle_yaw_rad_), viewpoint_);
  return c;
}

// An extent that no width has is the length; otherwise most objects move as the own vehicle does.
double ObjectPipeline::first_heading(const Candidate& c) const {
  const double yaw = c.shape.box.yaw_rad;
  const Vec3& size = c.shape.box.size_m;
  if (!c.heading_rad || size.head<2>().maxCoeff() < kWidestM) {
    return nearest_quarter(yaw, vehicle_yaw_rad_);
  }
  const double along = size.x() >= size.y() ? yaw : yaw + M_PI / 2;
  const double off = std::abs(wrapped(along - vehicle_yaw_rad_));
  return wrapped(off <= M_PI / 2 ? along : along + M_PI);
}

// Whether the track's width would be an extent that only a length has.
bool ObjectPipeline::is_across(const Candidate& c, double yaw_rad) const {
  if (!c.heading_rad) return false;
  const double off = wrapped(c.shape.box.yaw_rad - nearest_quarter(c.shape.box.yaw_rad, yaw_rad));
  const bool is_swapped = std::lround(std::abs(off) / (M_PI / 2)) % 2 != 0;
  const Vec3& size = c.shape.box.size_m;
  const double length = is_swapped ? size.y() : size.x(), width = is_swapped ? size.x() : size.y();
  return width > kWidestM && width > length + kClearlyM;
}

int ObjectPipeline::first_heading_turns(const Candidate& c, double yaw_rad) const {
  return std::abs(wrapped(first_heading(c) - yaw_rad - M_PI / 2)) < M_PI / 2 ? 1 : -1;
}

void ObjectPipeline::update(Track& track, uint32_t k) {
  const Candidate& c = candidates_[k];
  if (track.measurements && is_across(c, track.filter.yaw_rad())) {
    track.turn(options_.track, first_heading_turns(c, track.filter.yaw_rad()));
  }
  const double hint = track.measurements ? track.filter.yaw_rad() : first_heading(c);
  std::optional<double> heading;
  if (c.heading_rad) heading = nearest_quarter(*c.heading_rad, hint);
  const SegmentShape shape =
      ShapeFitter::measure(segments_.points(k), heading.value_or(hint), viewpoint_);
  const double speed = track.measurements > 2 ? std::abs(track.filter.speed_m_s()) : 0;
  classification_.observe(shape, speed, track.evidence);
  track.probability = classification_.probabilities(track.evidence);
  track.label = classification_.decide(track.probability);
  track.measure(options_.track, shape, heading, hint);
  track.follow_motion(options_.track);
  track.existence.update(options_.track.existence, track.label, shape.points, shape.extent_m());
}

void ObjectPipeline::assign() {
  const size_t columns = candidates_.size();
  cost_.assign(tracks_.size() * columns, std::numeric_limits<double>::infinity());
  for (size_t t = 0; t < tracks_.size(); ++t) {
    const auto& p = tracks_[t].filter.covariance();
    const double sigma = std::sqrt((p(0, 0) + p(1, 1)) / 2);
    const double gate = std::min(options_.gate_m + 2 * sigma, options_.most_gate_m);
    const Vec3 expected = tracks_[t].measured_centre_m();
    for (size_t c = 0; c < columns; ++c) {
      const double d = (candidates_[c].shape.box.centre_m - expected).head<2>().norm();
      if (d < gate) cost_[t * columns + c] = d;
    }
  }
  const auto partner = assignment_.solve(cost_, tracks_.size(), columns, options_.most_gate_m);
  taken_.assign(columns, 0);
  for (size_t t = 0; t < tracks_.size(); ++t) {
    if (partner[t] == kUnassigned) {
      tracks_[t].existence.update(options_.track.existence, tracks_[t].label, 0, 0);
      continue;
    }
    taken_[partner[t]] = 1;
    update(tracks_[t], partner[t]);
  }
}

void ObjectPipeline::begin_tracks() {
  for (uint32_t c = 0; c < candidates_.size(); ++c) {
    if (taken_[c]) continue;
    Track track;
    track.id = next_id_++;
    track.last_s = time_s_;
    update(track, c);
    tracks_.push_back(track);
  }
}

void ObjectPipeline::step(const MergedCloud& cloud, ObjectList& list) {
  time_s_ = tracks_.empty() ? cloud.time_s : std::max(time_s_, cloud.time_s);
  viewpoint_ = viewpoint_of(cloud);
  const Vec3 forward = cloud.world_from_vehicle.rotation * Vec3::UnitX();
  vehicle_yaw_rad_ = std::atan2(forward.y(), forward.x());
  find_candidates(cloud);
  for (Track& t : tracks_) t.predict(options_.track, time_s_);
  assign();
  begin_tracks();
  std::erase_if(tracks_,
                [&](const Track& t) { return t.existence.is_gone(options_.track.existence); });
  list.time_s = time_s_;
  list.available_s = std::max(cloud.available_s, time_s_) + options_.latency_s;
  list.world_from_vehicle = cloud.world_from_vehicle;
  list.objects.clear();
  for (const Track& t : tracks_) {
    if (t.existence.is_listed()) list.objects.push_back(t.reported());
  }
}

}  // namespace underbrush::perception
