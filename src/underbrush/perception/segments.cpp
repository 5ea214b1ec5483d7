#include "underbrush/perception/segments.hpp"

#include <algorithm>

namespace underbrush::perception {
namespace {

constexpr double kCellM = 2;
constexpr int kMostCells = 512;  // Along each axis.

}  // namespace

void Segments::gather(std::span<const Vec3> points, size_t count) {
  begin.assign(count + 1, 0);
  for (const uint32_t s : of_point) {
    if (s != kNoSegment) ++begin[s + 1];
  }
  for (size_t s = 0; s < count; ++s) begin[s + 1] += begin[s];
  point_m.resize(begin[count]);
  // Each begin moves to its segment's end, and then back by one place.
  for (size_t i = 0; i < points.size(); ++i) {
    if (of_point[i] != kNoSegment) point_m[begin[of_point[i]]++] = points[i];
  }
  for (size_t s = count; s > 0; --s) begin[s] = begin[s - 1];
  if (count) begin[0] = 0;
}

void BoxAssignment::prepare(std::span<const TruthObject> objects) {
  boxes_.clear();
  for (const TruthObject& o : objects) {
    const Vec3 half = o.box.size_m / 2;
    boxes_.push_back({o.box.centre_m.x(), o.box.centre_m.y(), o.box.centre_m.z(),
                      std::cos(o.box.yaw_rad), std::sin(o.box.yaw_rad),
                      half.x() + options_.margin_m, half.y() + options_.margin_m,
                      options_.above_bottom_m - half.z(), half.z() + options_.margin_m});
  }
}

// A box is entered in every cell that the circle around it touches.
void BoxAssignment::sort_into_cells() {
  double low_x = 0, low_y = 0, high_x = 0, high_y = 0;
  for (size_t k = 0; k < boxes_.size(); ++k) {
    const Prepared& b = boxes_[k];
    const double r = std::hypot(b.half_length, b.half_width);
    low_x = k ? std::min(low_x, b.x - r) : b.x - r;
    low_y = k ? std::min(low_y, b.y - r) : b.y - r;
    high_x = k ? std::max(high_x, b.x + r) : b.x + r;
    high_y = k ? std::max(high_y, b.y + r) : b.y + r;
  }
  origin_x_ = low_x;
  origin_y_ = low_y;
  const auto cells = [](double length) {
    return int(std::clamp(length / kCellM, 0.0, double(kMostCells - 1))) + 1;
  };
  columns_ = cells(high_x - low_x);
  rows_ = cells(high_y - low_y);
  cell_begin_.assign(size_t(columns_) * size_t(rows_) + 1, 0);
  const auto clamped = [](double at, int n) { return std::clamp(int(at / kCellM), 0, n - 1); };
  const auto visit = [&](const auto& f) {
    for (uint32_t k = 0; k < boxes_.size(); ++k) {
      const Prepared& b = boxes_[k];
      const double r = std::hypot(b.half_length, b.half_width);
      const int x0 = clamped(b.x - r - origin_x_, columns_);
      const int x1 = clamped(b.x + r - origin_x_, columns_);
      const int y1 = clamped(b.y + r - origin_y_, rows_);
      for (int y = clamped(b.y - r - origin_y_, rows_); y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) f(size_t(y) * size_t(columns_) + size_t(x), k);
      }
    }
  };
  visit([&](size_t cell, uint32_t) { ++cell_begin_[cell + 1]; });
  for (size_t c = 1; c < cell_begin_.size(); ++c) cell_begin_[c] += cell_begin_[c - 1];
  cell_box_.resize(cell_begin_.back());
  visit([&](size_t cell, uint32_t k) { cell_box_[cell_begin_[cell]++] = k; });
  for (size_t c = cell_begin_.size() - 1; c > 0; --c) cell_begin_[c] = cell_begin_[c - 1];
  cell_begin_[0] = 0;
}

void BoxAssignment::assign(std::span<const Vec3> points, std::span<const TruthObject> objects,
                           Segments& segments) {
  segments.of_point.assign(points.size(), kNoSegment);
  if (objects.empty()) return;
  prepare(objects);
  sort_into_cells();
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    const double x = (p.x() - origin_x_) / kCellM, y = (p.y() - origin_y_) / kCellM;
    if (!(x >= 0 && y >= 0 && x < 1e7 && y < 1e7)) continue;
    const size_t column = std::min(size_t(x), size_t(columns_ - 1));
    const size_t cell = std::min(size_t(y), size_t(rows_ - 1)) * size_t(columns_) + column;
    double deepest = 1;
    for (uint32_t at = cell_begin_[cell]; at < cell_begin_[cell + 1]; ++at) {
      const Prepared& b = boxes_[cell_box_[at]];
      const double dx = p.x() - b.x, dy = p.y() - b.y, dz = p.z() - b.z;
      if (dz < b.low || dz > b.high) continue;
      const double along = std::abs(b.cos * dx + b.sin * dy) / b.half_length;
      const double across = std::abs(b.cos * dy - b.sin * dx) / b.half_width;
      const double depth = std::max(along, across);
      if (depth < deepest || (depth == 1 && segments.of_point[i] == kNoSegment)) {
        deepest = depth;
        segments.of_point[i] = cell_box_[at];
      }
    }
  }
}

}  // namespace underbrush::perception
