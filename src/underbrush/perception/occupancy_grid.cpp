#include "underbrush/perception/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

void GridOptions::check() const {
  require(cell_m > 0 && half_side_m >= cell_m && half_side_m / cell_m <= 5000,
          "grid: cells out of range");
  for (size_t s = 0; s < 3; ++s) {
    require(hit[s] > 0 && hit[s] < 1 && prior[s] >= 0, "grid: a probability is out of range");
  }
  require(prior[0] > 0 && prior[0] + prior[1] + prior[2] > 0, "grid: no prior for free cells");
  require(low_m < high_m && memory >= 0 && memory <= 1 && most_evidence > 0,
          "grid: heights, memory or limit out of range");
}

OccupancyGrid::OccupancyGrid(const GridOptions& options) : options_(options) {
  options_.check();
  columns_ = 2 * size_t(std::ceil(options_.half_side_m / options_.cell_m));
  cells_.resize(columns_ * columns_);
  moved_.resize(cells_.size());
  for (size_t s = 0; s < 3; ++s) {
    on_hit_[s] = float(std::log(options_.hit[s]));
    on_pass_[s] = float(std::log(1 - options_.hit[s]));
  }
}

void OccupancyGrid::reset() {
  std::fill(cells_.begin(), cells_.end(), Evidence{});
  is_placed_ = false;
}

std::array<double, 2> OccupancyGrid::corner_m() const {
  return {double(first_x_) * options_.cell_m, double(first_y_) * options_.cell_m};
}

std::optional<size_t> OccupancyGrid::cell_at(double x_m, double y_m) const {
  const double x = std::floor(x_m / options_.cell_m) - double(first_x_);
  const double y = std::floor(y_m / options_.cell_m) - double(first_y_);
  const auto n = double(columns_);
  if (!(x >= 0 && y >= 0 && x < n && y < n)) return std::nullopt;
  return size_t(y) * columns_ + size_t(x);
}

std::array<double, 3> OccupancyGrid::probability(size_t x, size_t y) const {
  return probability(y * columns_ + x);
}

std::array<double, 3> OccupancyGrid::probability(size_t cell) const {
  std::array<double, 3> weight{};
  double sum = 0;
  for (size_t s = 0; s < 3; ++s) {
    weight[s] = options_.prior[s] * std::exp(double(cells_[cell][s]));
    sum += weight[s];
  }
  return {weight[0] / sum, weight[1] / sum, weight[2] / sum};
}

void OccupancyGrid::move_to(const Vec3& vehicle) {
  const auto half = int64_t(columns_ / 2);
  const auto x = int64_t(std::floor(vehicle.x() / options_.cell_m)) - half;
  const auto y = int64_t(std::floor(vehicle.y() / options_.cell_m)) - half;
  const auto n = int64_t(columns_);
  if (is_placed_ && (x != first_x_ || y != first_y_)) {
    std::fill(moved_.begin(), moved_.end(), Evidence{});
    for (int64_t row = 0; row < n; ++row) {
      const int64_t old_row = row + y - first_y_;
      if (old_row < 0 || old_row >= n) continue;
      for (int64_t column = 0; column < n; ++column) {
        const int64_t old_column = column + x - first_x_;
        if (old_column < 0 || old_column >= n) continue;
        moved_[size_t(row * n + column)] = cells_[size_t(old_row * n + old_column)];
      }
    }
    std::swap(cells_, moved_);
  }
  first_x_ = x;
  first_y_ = y;
  is_placed_ = true;
}

void OccupancyGrid::add(int64_t x, int64_t y, bool is_hit) {
  const int64_t column = x - first_x_, row = y - first_y_;
  const auto n = int64_t(columns_);
  if (column < 0 || row < 0 || column >= n || row >= n) return;
  Evidence& e = cells_[size_t(row * n + column)];
  const Evidence& by = is_hit ? on_hit_ : on_pass_;
  for (size_t s = 0; s < 3; ++s) e[s] += by[s];
  const float most = std::max({e[0], e[1], e[2]});
  for (float& likelihood : e) {
    likelihood = std::max(likelihood - most, -float(options_.most_evidence));
  }
}

// The part of the beam in the band is followed from cell to cell.
void OccupancyGrid::enter(const Vec3& from, const Vec3& to, double base_m, bool is_hit) {
  const Vec3 step = to - from;
  const double low = base_m + options_.low_m, high = base_m + options_.high_m;
  double begin = 0, end = 1;
  if (std::abs(step.z()) > 1e-9) {
    const double a = (low - from.z()) / step.z(), b = (high - from.z()) / step.z();
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  } else if (from.z() < low || from.z() > high) {
    return;
  }
  if (begin >= end) return;
  const double side = options_.cell_m;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Vec3 start = from + begin * step;
  auto x = int64_t(std::floor(start.x() / side)), y = int64_t(std::floor(start.y() / side));
  const int64_t dx = step.x() < 0 ? -1 : 1, dy = step.y() < 0 ? -1 : 1;
  // The share of the beam at which it crosses the next border, and between borders.
  const auto crossing = [&](double at, double by, int64_t cell, int64_t direction) {
    if (std::abs(by) < 1e-12) return kInfinity;
    return (double(cell + (direction > 0)) * side - at) / by;
  };
  double next_x = crossing(from.x(), step.x(), x, dx), next_y = crossing(from.y(), step.y(), y, dy);
  const double every_x = std::abs(step.x()) < 1e-12 ? kInfinity : side / std::abs(step.x());
  const double every_y = std::abs(step.y()) < 1e-12 ? kInfinity : side / std::abs(step.y());
  while (std::min(next_x, next_y) < end) {
    add(x, y, false);
    if (next_x < next_y) {
      x += dx;
      next_x += every_x;
    } else {
      y += dy;
      next_y += every_y;
    }
  }
  add(x, y, is_hit && end >= 1);
}

void OccupancyGrid::step(const MergedCloud& cloud) {
  const Pose& pose = cloud.world_from_vehicle;
  move_to(pose.translation);
  const auto memory = float(options_.memory);
  for (Evidence& e : cells_) {
    for (float& likelihood : e) likelihood *= memory;
  }
  const double base_m = pose.translation.z();
  const auto from = [&](uint16_t sensor) -> Vec3 {
    return pose * cloud.sensor_m[sensor].cast<double>();
  };
  for (size_t i = 0; i < cloud.miss_m.size(); ++i) {
    enter(from(cloud.miss_sensor[i]), pose * cloud.miss_m[i].cast<double>(), base_m, false);
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    enter(from(cloud.sensor[i]), pose * cloud.point_m[i].cast<double>(), base_m, true);
  }
}

}  // namespace underbrush::perception
