#include "underbrush/trace/ground_heights.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::trace {

using elements::ObservedSpace;

// long: heights and shares are of the same cells.
GroundHeights::GroundHeights(const elements::TriangleMesh& ground, const std::vector<bool>& keep,
                             std::span<const elements::LostBeams> lost) {
  constexpr double kMarginM = 128, kMostCells = 1 << 22;  // the margin lies around the ground
  const auto kept = [&](size_t i) { return keep.empty() || keep[i]; };
  const auto cell = [&](size_t i) {
    const Vec3f& v = ground.vertices[i];
    return cell_of(double(v.x()), double(v.y()), side_m_);
  };
  Vec3f low = Vec3f::Constant(HUGE_VALF), high = -low;
  for (size_t i = 0; i < ground.vertices.size(); ++i) {
    if (!kept(i)) continue;
    low = low.cwiseMin(ground.vertices[i]);
    high = high.cwiseMax(ground.vertices[i]);
  }
  if (low.x() > high.x()) return;
  const auto along = [&](int axis) {
    return double(high[axis] - low[axis]) / side_m_ + 2 + 2 * kMarginM / side_m_;
  };
  while (along(0) * along(1) > kMostCells) side_m_ *= 2;
  const auto margin = int32_t(kMarginM / side_m_);
  const Cell2 first = cell_of(double(low.x()), double(low.y()), side_m_),
              last = cell_of(double(high.x()), double(high.y()), side_m_);
  low_ = {first.x - margin, first.y - margin};
  nx_ = last.x - first.x + 1 + 2 * margin;
  ny_ = last.y - first.y + 1 + 2 * margin;
  const size_t cells = size_t(nx_) * size_t(ny_);
  std::vector<double> sum(cells), count(cells);
  for (size_t i = 0; i < ground.vertices.size(); ++i) {
    if (!kept(i)) continue;
    const Cell2 c = cell(i);
    const size_t k = size_t(c.y - low_.y) * size_t(nx_) + size_t(c.x - low_.x);
    sum[k] += double(ground.vertices[i].z());
    ++count[k];
  }
  height_m_.resize(cells);
  known_.resize(cells);
  lowest_m_ = HUGE_VAL, highest_m_ = -HUGE_VAL;
  std::vector<size_t> front;
  for (size_t k = 0; k < cells; ++k) {
    if (count[k] == 0) continue;
    height_m_[k] = float(sum[k] / count[k]);
    known_[k] = 1;
    lowest_m_ = std::min(lowest_m_, double(height_m_[k]));
    highest_m_ = std::max(highest_m_, double(height_m_[k]));
    front.push_back(k);
  }
  extend(height_m_, front);
  if (lost.empty()) return;
  share_.resize(cells);
  for (const size_t k : front) share_[k] = 1;
  for (const elements::LostBeams& l : lost) {
    const double side = ObservedSpace::kSquareM;
    const Cell2 c = cell_of((l.at.x + 0.5) * side, (l.at.y + 0.5) * side, side_m_);
    const int32_t x = c.x - low_.x, y = c.y - low_.y;
    if (x < 0 || y < 0 || x >= nx_ || y >= ny_) continue;
    const size_t k = size_t(y) * size_t(nx_) + size_t(x);
    if (count[k] > 0) continue;
    if (share_[k] == 0) front.push_back(k);
    share_[k] = float(1 / (1.0 + l.beams));
  }
  extend(share_, std::move(front));
}

void GroundHeights::extend(std::vector<float>& values, std::vector<size_t> front) const {
  std::vector<uint8_t> is_known(values.size()), sources(values.size());
  for (const size_t k : front) is_known[k] = 1;
  while (!front.empty()) {
    std::vector<size_t> next;
    for (const size_t k : front) {
      const int32_t x = int32_t(k % size_t(nx_)), y = int32_t(k / size_t(nx_));
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= nx_ || y + dy >= ny_) continue;
        const size_t n = size_t(y + dy) * size_t(nx_) + size_t(x + dx);
        if (is_known[n]) continue;
        if (sources[n]++ == 0) next.push_back(n);
        values[n] += values[k];
      }
    }
    for (const size_t n : next) {
      values[n] /= float(sources[n]);
      is_known[n] = 1;
    }
    front = std::move(next);
  }
}

std::optional<double> GroundHeights::entry(const Ray& ray, const RangeLimits& limits,
                                           double step_m) const {
  if (empty() || !(ray.direction.z() < 0)) return {};
  const double from = (highest_m_ - ray.origin.z()) / ray.direction.z();
  const double lowest = (lowest_m_ - ray.origin.z()) / ray.direction.z();
  const double to = std::min(limits.max_m, lowest);
  for (double t = std::max(limits.min_m, from); t < to; t += step_m) {
    const Vec3 p = ray.origin + t * ray.direction;
    if (p.z() < at(p.x(), p.y())) return t;
  }
  if (lowest < limits.max_m) return std::max(limits.min_m, lowest);
  return {};
}

double GroundHeights::between(const std::vector<float>& values, double x, double y) const {
  const double u = std::clamp(x / side_m_ - 0.5 - low_.x, 0.0, double(nx_ - 1) - 1e-9);
  const double v = std::clamp(y / side_m_ - 0.5 - low_.y, 0.0, double(ny_ - 1) - 1e-9);
  const int32_t i = int32_t(u), j = int32_t(v);
  const double a = u - i, b = v - j;
  const float* row = &values[size_t(j) * size_t(nx_) + size_t(i)];
  return (1 - b) * ((1 - a) * double(row[0]) + a * double(row[1])) +
         b * ((1 - a) * double(row[nx_]) + a * double(row[nx_ + 1]));
}

GroundHeights::Interval GroundHeights::interval(double at, double length_m, int32_t low,
                                                int32_t count) const {
  const auto node = [&](double to) {
    return int32_t(std::clamp(to / side_m_ - 0.5 - low, 0.0, double(count - 1) - 1e-9));
  };
  return {node(at), node(at + length_m) + 1, cell_index(at, side_m_) - low,
          cell_index(at + length_m, side_m_) - low};
}

std::array<double, 2> GroundHeights::bounds(const Interval& x, const Interval& y) const {
  float low = HUGE_VALF, high = -HUGE_VALF;
  for (int32_t j = y.first; j <= y.last; ++j) {
    const float* row = &height_m_[size_t(j) * size_t(nx_)];
    for (int32_t i = x.first; i <= x.last; ++i) {
      low = std::min(low, row[i]);
      high = std::max(high, row[i]);
    }
  }
  return {double(low), double(high)};
}

bool GroundHeights::is_known(const Interval& x, const Interval& y) const {
  for (int32_t j = y.begin; j <= y.end; ++j) {
    for (int32_t i = x.begin; i <= x.end; ++i) {
      if (!has_ground(i, j)) return false;
    }
  }
  return true;
}

}  // namespace underbrush::trace
