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
  counts_.resize((columns_ + 2) * (columns_ + 2));
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

// Follows a beam from cell to cell. Places are in cells from the corner of the border, and the part
// between `begin` and `end`, shares of the step, lies inside the grid. Rounding may lead at most
// one cell astray, and then into the border.
void OccupancyGrid::count_cells(const Vec3& from, const Vec3& step, double begin, double end,
                                bool is_hit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto stride = std::ptrdiff_t(columns_ + 2);
  const auto cell = [&](double at) {
    return std::clamp(std::ptrdiff_t(at), std::ptrdiff_t(1), std::ptrdiff_t(columns_));
  };
  const std::ptrdiff_t x = cell(from.x() + begin * step.x()), y = cell(from.y() + begin * step.y());
  const std::ptrdiff_t last_x = cell(from.x() + end * step.x());
  const std::ptrdiff_t last_y = cell(from.y() + end * step.y());
  // The shares of the step between two borders of cells, and at which it crosses the next ones.
  const double every_x = 1 / std::abs(step.x()), every_y = 1 / std::abs(step.y());
  const auto crossing = [&](std::ptrdiff_t at, int axis, std::ptrdiff_t end_at, double every) {
    if (at == end_at) return kInfinity;
    return every * std::abs(double(at + (step[axis] > 0)) - from[axis]);
  };
  double next_x = crossing(x, 0, last_x, every_x), next_y = crossing(y, 1, last_y, every_y);
  const std::ptrdiff_t dx = step.x() < 0 ? -1 : 1, dy = step.y() < 0 ? -stride : stride;
  Count* at = &counts_[size_t(y * stride + x)];
  for (auto n = std::abs(last_x - x) + std::abs(last_y - y); n > 0; --n) {
    ++at->passes;
    const bool is_x = next_x < next_y;
    at += is_x ? dx : dy;
    next_x += is_x ? every_x : 0;
    next_y += is_x ? 0 : every_y;
  }
  Count& last = counts_[size_t(last_y * stride + last_x)];
  ++(is_hit ? last.hits : last.passes);
}

// Counts a beam in the cells that it crosses in the band of heights. Its z is in m above the
// vehicle, x and y are in cells.
void OccupancyGrid::count(const Vec3& from, const Vec3& to, bool is_hit) {
  const Vec3 step = to - from;
  double begin = 0, end = 1;
  const auto limit = [&](int axis, double least, double most) {
    if (std::abs(step[axis]) > 1e-12) {
      const double a = (least - from[axis]) / step[axis], b = (most - from[axis]) / step[axis];
      begin = std::max(begin, std::min(a, b));
      end = std::min(end, std::max(a, b));
    } else if (!(from[axis] >= least && from[axis] < most)) {
      end = -1;
    }
  };
  limit(2, options_.low_m, options_.high_m);
  limit(0, 1, double(columns_ + 1));
  limit(1, 1, double(columns_ + 1));
  if (begin < end) count_cells(from, step, begin, end, is_hit && end >= 1);
}

void OccupancyGrid::add_counts() {
  const auto memory = float(options_.memory), least = -float(options_.most_evidence);
  for (size_t y = 0; y < columns_; ++y) {
    const Count* count = &counts_[(y + 1) * (columns_ + 2) + 1];
    Evidence* cell = &cells_[y * columns_];
    for (size_t x = 0; x < columns_; ++x) {
      Evidence& e = cell[x];
      for (float& likelihood : e) likelihood *= memory;
      const auto hits = float(count[x].hits), passes = float(count[x].passes);
      if (hits + passes == 0) continue;
      for (size_t s = 0; s < 3; ++s) e[s] += hits * on_hit_[s] + passes * on_pass_[s];
      const float most = std::max({e[0], e[1], e[2]});
      for (float& likelihood : e) likelihood = std::max(likelihood - most, least);
    }
  }
}

void OccupancyGrid::step(const MergedCloud& cloud) {
  const Pose& pose = cloud.world_from_vehicle;
  move_to(pose.translation);
  std::fill(counts_.begin(), counts_.end(), Count{});
  const Vec3 per_m(1 / options_.cell_m, 1 / options_.cell_m, 1);
  const Vec3 corner(double(first_x_ - 1), double(first_y_ - 1), pose.translation.z());
  const auto placed = [&](const Vec3f& p) -> Vec3 {
    return (pose * p.cast<double>()).cwiseProduct(per_m) - corner;
  };
  sensors_.clear();
  for (const Vec3f& p : cloud.sensor_m) sensors_.push_back(placed(p));
  for (size_t i = 0; i < cloud.miss_m.size(); ++i) {
    count(sensors_[cloud.miss_sensor[i]], placed(cloud.miss_m[i]), false);
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    count(sensors_[cloud.sensor[i]], placed(cloud.point_m[i]), true);
  }
  add_counts();
}

}  // namespace underbrush::perception
