#include "underbrush/perception/track.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

Vec3 corner_of(const OrientedBox& box, const std::array<int, 2>& signs) {
  const Vec3 half = box.size_m / 2;
  return box.from_box({signs[0] * half.x(), signs[1] * half.y(), 0});
}

}  // namespace

void TrackOptions::check() const {
  existence.check();
  motion.check();
  require(size_window >= 1 && size_window <= kMostWindow,
          "track: the window must be 1 to 8 cycles");
  require(least_size_m.minCoeff() >= 0 && heading_distance_m > 0,
          "track: least sizes must not be negative, and the heading's distance positive");
}

void Track::predict(const TrackOptions& o, double time_s) {
  is_measured = false;
  points = 0;
  if (measurements && time_s > last_s) filter.predict(o.motion, time_s - last_s);
  last_s = time_s;
}

// Means over the last cycles; the σ are averaged likewise, because errors of one view persist.
void Track::add_extents(const TrackOptions& o, const SegmentShape& shape,
                        const CompletedBox& whole) {
  const auto n = uint32_t(o.size_window);
  const size_t at = measurements % n;
  window[0][at] = shape.box.size_m;
  window[1][at] = whole.box.size_m;
  window[2][at] = whole.sigma_m;
  const uint32_t count = std::min(measurements + 1, n);
  std::array<Vec3, 3> mean{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (size_t k = 0; k < 3; ++k) {
    for (uint32_t i = 0; i < count; ++i) mean[k] += window[k][i] / count;
  }
  measured_m = mean[0];
  size_m = mean[1].cwiseMax(o.least_size_m);
  size_sigma_m = mean[2];
}

// The corner may become another one when the object passes; the state then moves along the box.
Vec3 Track::reference_of(const TrackOptions& o, const SegmentShape& shape,
                         const OrientedBox& whole) {
  if (o.reference == ReferencePoint::kCentreOfGravity) return shape.centre_of_gravity_m;
  if (o.reference == ReferencePoint::kGeometricCentre) return whole.centre_m;
  const std::array<int, 2> now{shape.viewpoint_m.x() < 0 ? -1 : 1,
                               shape.viewpoint_m.y() < 0 ? -1 : 1};
  if (measurements && now != corner) {
    const Vec3 half = size_m / 2;
    const OrientedBox axes{Vec3::Zero(), filter.yaw_rad(), size_m};
    const Vec3 by =
        axes.from_box({(now[0] - corner[0]) * half.x(), (now[1] - corner[1]) * half.y(), 0});
    filter.shift(by);
    anchor_m += by;
  }
  corner = now;
  return corner_of(whole, corner);
}

void Track::measure(const TrackOptions& o, const SegmentShape& shape,
                    std::optional<double> heading_rad, double hint_rad) {
  const CompletedBox whole = complete(shape, label, o.completion);
  const Vec3 reference = reference_of(o, shape, whole.box);
  add_extents(o, shape, whole);
  if (measurements == 0) {
    filter.start(o.motion, reference, heading_rad, hint_rad);
    begin_s = measured_s = last_s;
    anchor_m = reference;
  } else {
    const double since_s = last_s - measured_s;
    const bool is_second = measurements == 1 && since_s > 0;
    const Vec3 before = filter.position_m();
    // At the second measurement the speed is not known yet, so the state has not moved.
    if (is_second)
      filter.set_velocity(o.motion, reference - before, since_s, heading_rad.has_value());
    filter.update(o.motion, reference, heading_rad, is_second ? 0 : since_s);
    measured_s = last_s;
  }
  const OrientedBox axes{reference, filter.yaw_rad(), size_m};
  offset_m =
      OrientedBox{Vec3::Zero(), shape.box.yaw_rad, {}}.to_box(whole.box.centre_m - reference);
  if (o.reference == ReferencePoint::kCorner) {
    offset_m.head<2>() = Eigen::Vector2d(-corner[0] * size_m.x(), -corner[1] * size_m.y()) / 2;
  }
  measured_offset_m = axes.to_box(shape.box.centre_m);
  points = shape.points;
  is_measured = true;
  ++measurements;
}

void Track::follow_motion(const TrackOptions& o) {
  const Vec3 moved = filter.position_m() - anchor_m;
  if (moved.head<2>().norm() < o.heading_distance_m) return;
  anchor_m = filter.position_m();
  const double direction = std::atan2(moved.y(), moved.x());
  const int quarters = int(std::lround(wrapped(direction - filter.yaw_rad()) / (M_PI / 2)));
  if (quarters != 0) turn(o, quarters);
}

void Track::turn(const TrackOptions& o, int quarters) {
  filter.turn(o.motion, quarters);
  if (quarters % 2 != 0) {
    std::swap(size_m.x(), size_m.y());
    std::swap(measured_m.x(), measured_m.y());
    std::swap(size_sigma_m.x(), size_sigma_m.y());
    measurements = 1;  // The window begins anew, and the speed is set by the next measurement.
    for (auto& w : window) std::swap(w[0].x(), w[0].y());
  }
  const OrientedBox turned{Vec3::Zero(), quarters * M_PI / 2, {}};
  offset_m = turned.to_box(offset_m);
  measured_offset_m = turned.to_box(measured_offset_m);
  const Vec3 signs = turned.to_box({double(corner[0]), double(corner[1]), 0});
  corner = {signs.x() < 0 ? -1 : 1, signs.y() < 0 ? -1 : 1};
}

Vec3 Track::measured_centre_m() const {
  return OrientedBox{filter.position_m(), filter.yaw_rad(), {}}.from_box(measured_offset_m);
}

TrackedObject Track::reported() const {
  TrackedObject o;
  o.id = id;
  o.truth_id = truth_id;
  o.label = label;
  o.probability = probability;
  o.existence = existence.probability();
  o.age_s = last_s - begin_s;
  o.is_measured = is_measured;
  o.points = points;
  o.reference_m = filter.position_m();
  const OrientedBox axes{o.reference_m, filter.yaw_rad(), size_m};
  o.box = {axes.from_box(offset_m), filter.yaw_rad(), size_m};
  o.measured_size_m = measured_m;
  o.velocity_m_s = filter.velocity_m_s();
  o.acceleration_m_s2 = filter.acceleration_m_s2();
  o.yaw_rate_rad_s = filter.yaw_rate_rad_s();
  const auto& p = filter.covariance();
  // The centre is as uncertain as the reference point, and as half of what the extents are.
  const Vec3 half = size_sigma_m / 2;
  const double c = std::cos(axes.yaw_rad), s = std::sin(axes.yaw_rad);
  o.position_sigma_m = {std::sqrt(p(0, 0) + std::pow(c * half.x(), 2) + std::pow(s * half.y(), 2)),
                        std::sqrt(p(1, 1) + std::pow(s * half.x(), 2) + std::pow(c * half.y(), 2)),
                        std::hypot(std::sqrt(filter.height_variance_m2()), half.z())};
  o.yaw_sigma_rad = std::sqrt(p(2, 2));
  o.size_sigma_m = size_sigma_m;
  o.speed_sigma_m_s = std::sqrt(p(3, 3));
  return o;
}

}  // namespace underbrush::perception
