#include "underbrush/perception/segment_shape.hpp"

#include <algorithm>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

struct Extent {
  float low = std::numeric_limits<float>::max(), high = -std::numeric_limits<float>::max();
  void add(float x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

}  // namespace

void ShapeOptions::check() const {
  require(coarse_headings >= 2 && fine_headings >= 0, "shape: too few headings");
  require(least_distance_m > 0, "shape: the least distance must be positive");
  require(heading_points >= 2 && heading_extent_m >= 0 && (outline == 0 || outline >= 8),
          "shape: a heading needs two points, and an outline 8");
}

ShapeFitter::ShapeFitter(const ShapeOptions& options) : options_(options) { options_.check(); }

// The outline is relative to the mean, so that float is exact enough.
void ShapeFitter::make_outline(std::span<const Vec3> points, const Vec3& viewpoint) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p;
  mean /= double(points.size());
  x_.clear();
  y_.clear();
  const Eigen::Vector2d to_mean = (mean - viewpoint).head<2>();
  const double distance = to_mean.norm();
  if (options_.outline == 0 || points.size() <= options_.outline || distance < 1e-3) {
    for (const Vec3& p : points) {
      x_.push_back(float(p.x() - mean.x()));
      y_.push_back(float(p.y() - mean.y()));
    }
    return;
  }
  const Eigen::Vector2d forward = to_mean / distance, left(-forward.y(), forward.x());
  Extent tangent;
  along_.resize(points.size());
  across_.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d d = (points[i] - viewpoint).head<2>();
    along_[i] = float(d.dot(forward));
    across_[i] = float(d.dot(left) / std::max(d.dot(forward), 1e-3));
    tangent.add(across_[i]);
  }
  const size_t bins = options_.outline;
  const float scale = float(bins) / std::max(tangent.high - tangent.low, 1e-6f);
  nearest_.assign(3 * bins, std::numeric_limits<float>::max());
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t bin = std::min(bins - 1, size_t((across_[i] - tangent.low) * scale));
    if (along_[i] >= nearest_[3 * bin]) continue;
    nearest_[3 * bin] = along_[i];
    nearest_[3 * bin + 1] = float(points[i].x() - mean.x());
    nearest_[3 * bin + 2] = float(points[i].y() - mean.y());
  }
  for (size_t bin = 0; bin < bins; ++bin) {
    if (nearest_[3 * bin] == std::numeric_limits<float>::max()) continue;
    x_.push_back(nearest_[3 * bin + 1]);
    y_.push_back(nearest_[3 * bin + 2]);
  }
}

// [zhang17] Alg. 4: of the two opposite sides it takes the one to which the points are nearer.
double ShapeFitter::closeness(double heading_rad) {
  const auto c = float(std::cos(heading_rad)), s = float(std::sin(heading_rad));
  const size_t n = x_.size();
  Extent first, second;
  float sum_first = 0, sum_second = 0;
  along_.resize(n);
  across_.resize(n);
  for (size_t i = 0; i < n; ++i) {
    along_[i] = c * x_[i] + s * y_[i];
    across_[i] = c * y_[i] - s * x_[i];
    first.add(along_[i]);
    second.add(across_[i]);
    sum_first += along_[i];
    sum_second += across_[i];
  }
  const auto side = [n](const Extent& e, float sum) {
    return sum / float(n) > (e.low + e.high) / 2 ? e.high : e.low;
  };
  const float edge = side(first, sum_first), other = side(second, sum_second);
  const auto least = float(options_.least_distance_m);
  float total = 0;
  for (size_t i = 0; i < n; ++i) {
    const float d = std::min(std::abs(along_[i] - edge), std::abs(across_[i] - other));
    total += 1 / std::max(d, least);
  }
  return double(total);
}

std::optional<double> ShapeFitter::heading(std::span<const Vec3> points, const Vec3& viewpoint) {
  if (points.size() < options_.heading_points) return std::nullopt;
  Eigen::Vector2d low = points.front().head<2>(), high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  if ((high - low).maxCoeff() < options_.heading_extent_m) return std::nullopt;
  make_outline(points, viewpoint);
  const double step = M_PI / 2 / options_.coarse_headings;
  double best = 0, most = -1;
  const auto attempt = [&](double heading_rad) {
    const double value = closeness(heading_rad);
    if (value > most) {
      most = value;
      best = heading_rad;
    }
  };
  for (int k = 0; k < options_.coarse_headings; ++k) attempt(k * step);
  const double middle = best;
  for (int k = 1; k <= options_.fine_headings; ++k) {
    attempt(middle + step * (2.0 * k / (options_.fine_headings + 1) - 1));
  }
  const double quarter = M_PI / 2;
  const double turned = best - quarter * std::floor(best / quarter);
  return turned < quarter ? turned : 0;
}

SegmentShape ShapeFitter::measure(std::span<const Vec3> points, double yaw_rad,
                                  const Vec3& viewpoint) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  const Vec3& first = points.front();
  Vec3 low = Vec3::Zero(), high = Vec3::Zero(), sum = Vec3::Zero();
  for (const Vec3& p : points) {
    const Vec3 d = p - first;
    const Vec3 turned(c * d.x() + s * d.y(), c * d.y() - s * d.x(), d.z());
    low = low.cwiseMin(turned);
    high = high.cwiseMax(turned);
    sum += turned;
  }
  const auto back = [&](const Vec3& t) -> Vec3 {
    return first + Vec3(c * t.x() - s * t.y(), s * t.x() + c * t.y(), t.z());
  };
  SegmentShape shape;
  shape.box = {back((low + high) / 2), wrapped(yaw_rad), high - low};
  shape.centre_of_gravity_m = back(sum / double(points.size()));
  shape.viewpoint_m = shape.box.to_box(viewpoint);
  shape.points = uint32_t(points.size());
  return shape;
}

double nearest_quarter(double heading_rad, double hint_rad) {
  const double quarter = M_PI / 2;
  return wrapped(heading_rad + quarter * std::round((hint_rad - heading_rad) / quarter));
}

}  // namespace underbrush::perception
