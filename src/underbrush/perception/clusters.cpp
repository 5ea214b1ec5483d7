#include "underbrush/perception/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/ground/segment.hpp"

namespace underbrush::perception {
namespace {

constexpr float kNoHeight = std::numeric_limits<float>::infinity();
constexpr size_t kNoCell = SIZE_MAX;
constexpr size_t kBlock = 4;  // Cells along the side of a block, of which 3 x 3 define a pit.

}  // namespace

void ClusterOptions::check() const {
  require(ground == "cone" || ground == "lower_envelope", "clusters: unknown method of the ground");
  require(reach_m > 0 && reach_m <= 1000 && ground_cell_m >= 0.1 && cell_m >= 0.05,
          "clusters: reach or cells out of range");
  require(slope >= 0 && clearance_m > 0 && highest_m > clearance_m,
          "clusters: slope or heights out of range");
  require(gap_m > 0 && gap_rad >= 0 && gap_m + gap_rad * reach_m < 20 && largest_m > 0,
          "clusters: gap or largest extent out of range");
}

Clusters::Clusters(const ClusterOptions& options) : options_(options) {
  options_.check();
  ground_columns_ = size_t(std::ceil(2 * options_.reach_m / options_.ground_cell_m));
  columns_ = size_t(std::ceil(2 * options_.reach_m / options_.cell_m));
  entry_.assign(columns_ * columns_, kNoSegment);
}

size_t Clusters::cell_of(const Vec3f& p, double side_m, size_t columns) const {
  const double x = (double(p.x()) + options_.reach_m) / side_m;
  const double y = (double(p.y()) + options_.reach_m) / side_m;
  const auto n = double(columns);
  if (!(x >= 0 && y >= 0 && x < n && y < n)) return kNoCell;
  return size_t(y) * columns + size_t(x);
}

// Reflections in cars and windows show points below the ground. On a slope the cells of a block lie
// above the lower quartile of the nine blocks around, so a cell far below it is one of those.
void Clusters::remove_pits() {
  const size_t n = ground_columns_, blocks = (n + kBlock - 1) / kBlock;
  const auto depth = float(options_.clearance_m);
  second_.assign(n * n, kNoHeight);
  const auto for_each_cell = [&](size_t x0, size_t x1, size_t y0, size_t y1, const auto& f) {
    for (size_t y = y0 * kBlock; y < std::min(y1 * kBlock, n); ++y) {
      for (size_t x = x0 * kBlock; x < std::min(x1 * kBlock, n); ++x) f(y * n + x);
    }
  };
  for (size_t by = 0; by < blocks; ++by) {
    for (size_t bx = 0; bx < blocks; ++bx) {
      around_.clear();
      for_each_cell(bx ? bx - 1 : 0, bx + 2, by ? by - 1 : 0, by + 2, [&](size_t c) {
        if (height_[c] != kNoHeight) around_.push_back(height_[c]);
      });
      if (around_.empty()) continue;
      const auto quarter = around_.begin() + std::ptrdiff_t(around_.size() / 4);
      std::nth_element(around_.begin(), quarter, around_.end());
      for_each_cell(bx, bx + 1, by, by + 1, [&](size_t c) {
        if (height_[c] >= *quarter - depth) second_[c] = height_[c];
      });
    }
  }
  std::swap(height_, second_);
}

// Two passes of a distance transform, in which a step costs its length times the slope.
void Clusters::spread_heights() {
  const auto step = float(options_.slope * options_.ground_cell_m);
  const float diagonal = step * std::sqrt(2.0f);
  const size_t n = ground_columns_;
  const auto relax = [&](size_t to, size_t from, float cost) {
    height_[to] = std::min(height_[to], height_[from] + cost);
  };
  for (size_t y = 0; y < n; ++y) {
    for (size_t x = 0; x < n; ++x) {
      const size_t at = y * n + x;
      if (x > 0) relax(at, at - 1, step);
      if (y > 0) relax(at, at - n, step);
      if (x > 0 && y > 0) relax(at, at - n - 1, diagonal);
      if (x + 1 < n && y > 0) relax(at, at - n + 1, diagonal);
    }
  }
  for (size_t y = n; y-- > 0;) {
    for (size_t x = n; x-- > 0;) {
      const size_t at = y * n + x;
      if (x + 1 < n) relax(at, at + 1, step);
      if (y + 1 < n) relax(at, at + n, step);
      if (x + 1 < n && y + 1 < n) relax(at, at + n + 1, diagonal);
      if (x > 0 && y + 1 < n) relax(at, at + n - 1, diagonal);
    }
  }
}

// The second lowest point stands for a cell, so that a single wrong one does no harm.
void Clusters::find_ground(const MergedCloud& cloud) {
  const size_t cells = ground_columns_ * ground_columns_;
  height_.assign(cells, kNoHeight);
  second_.assign(cells, kNoHeight);
  for (const Vec3f& p : cloud.point_m) {
    const size_t c = cell_of(p, options_.ground_cell_m, ground_columns_);
    if (c == kNoCell) continue;
    if (p.z() < height_[c]) {
      second_[c] = height_[c];
      height_[c] = p.z();
    } else {
      second_[c] = std::min(second_[c], p.z());
    }
  }
  std::swap(height_, second_);
  remove_pits();
  spread_heights();
  ground_.assign(cloud.size(), 0);
  const bool is_cone = options_.ground == "cone";
  for (size_t i = 0; is_cone && i < cloud.size(); ++i) {
    const size_t c = cell_of(cloud.point_m[i], options_.ground_cell_m, ground_columns_);
    if (c == kNoCell) continue;
    ground_[i] = cloud.point_m[i].z() - height_[c] < float(options_.clearance_m);
  }
  if (!is_cone) ground_ = ground::lower_envelope(cloud.point_m);
}

void Clusters::enter(const MergedCloud& cloud) {
  for (const uint32_t c : cell_) entry_[c] = kNoSegment;
  cell_.clear();
  of_point_.assign(cloud.size(), kNoSegment);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3f& p = cloud.point_m[i];
    const size_t c = cell_of(p, options_.cell_m, columns_);
    if (ground_[i] || c == kNoCell) continue;
    const size_t g = cell_of(p, options_.ground_cell_m, ground_columns_);
    if (g != kNoCell && p.z() - height_[g] > float(options_.highest_m)) continue;
    if (entry_[c] == kNoSegment) {
      entry_[c] = uint32_t(cell_.size());
      cell_.push_back(uint32_t(c));
    }
    of_point_[i] = entry_[c];
  }
}

uint32_t Clusters::root(uint32_t cell) {
  while (parent_[cell] != cell) cell = parent_[cell] = parent_[parent_[cell]];
  return cell;
}

// Each pair of cells is seen from the one that is later in the plane.
void Clusters::connect(const MergedCloud& cloud) {
  parent_.resize(cell_.size());
  for (uint32_t k = 0; k < parent_.size(); ++k) parent_[k] = k;
  Vec3f from = Vec3f::Zero();
  for (const Vec3f& s : cloud.sensor_m) from += s / float(cloud.sensor_m.size());
  const double half = options_.reach_m;
  for (uint32_t k = 0; k < cell_.size(); ++k) {
    const auto x = int64_t(cell_[k] % columns_), y = int64_t(cell_[k] / columns_);
    const double range = std::hypot((double(x) + 0.5) * options_.cell_m - half - double(from.x()),
                                    (double(y) + 0.5) * options_.cell_m - half - double(from.y()));
    const double gap = std::max(options_.gap_m, options_.gap_rad * range) / options_.cell_m;
    const auto reach = int64_t(std::ceil(gap));
    for (int64_t dy = -reach; dy <= 0; ++dy) {
      for (int64_t dx = -reach; dx <= (dy ? reach : -1); ++dx) {
        if (double(dx * dx + dy * dy) > gap * gap) continue;
        const int64_t ox = x + dx, oy = y + dy;
        if (ox < 0 || oy < 0 || ox >= int64_t(columns_)) continue;
        const uint32_t other = entry_[size_t(oy) * columns_ + size_t(ox)];
        if (other == kNoSegment) continue;
        const uint32_t a = root(k), b = root(other);
        parent_[std::max(a, b)] = std::min(a, b);
      }
    }
  }
}

void Clusters::number(const MergedCloud& cloud, std::span<const Vec3> world, Segments& segments) {
  count_.assign(cell_.size(), 0);
  low_.assign(cell_.size(), Vec3f::Constant(kNoHeight));
  high_.assign(cell_.size(), Vec3f::Constant(-kNoHeight));
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (of_point_[i] == kNoSegment) continue;
    const uint32_t r = of_point_[i] = root(of_point_[i]);
    ++count_[r];
    low_[r] = low_[r].cwiseMin(cloud.point_m[i]);
    high_[r] = high_[r].cwiseMax(cloud.point_m[i]);
  }
  number_.assign(cell_.size(), kNoSegment);
  uint32_t next = 0;
  segments.of_point.assign(cloud.size(), kNoSegment);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const uint32_t r = of_point_[i];
    if (r == kNoSegment || count_[r] < options_.least_points) continue;
    if ((high_[r] - low_[r]).head<2>().norm() > float(options_.largest_m)) continue;
    if (number_[r] == kNoSegment) number_[r] = next++;
    segments.of_point[i] = number_[r];
  }
  segments.gather(world, next);
}

void Clusters::find(const MergedCloud& cloud, std::span<const Vec3> world, Segments& segments) {
  require(world.size() == cloud.size(), "clusters: the clouds differ in length");
  find_ground(cloud);
  enter(cloud);
  connect(cloud);
  number(cloud, world, segments);
}

}  // namespace underbrush::perception
