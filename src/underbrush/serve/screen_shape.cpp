#include "underbrush/serve/screen_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::serve {
namespace {

constexpr int kMostCells = 256;  // along a side of the mask
constexpr size_t kMostCorners = 4096;

double squared_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * along).squaredNorm();
}

}  // namespace

ScreenShape::ScreenShape(const DrawnShape& shape) : shape_(shape) {
  require(shape.clip_from_point.allFinite(), "a camera that is not finite");
  require(shape.width_px >= 1 && shape.height_px >= 1 && shape.width_px <= 1e5 &&
              shape.height_px <= 1e5,
          "a picture without size");
  const bool brush = shape.radius_px > 0;
  require(shape.path_px.size() >= (brush ? 1u : 3u), "a shape of too few corners");
  require(shape.path_px.size() <= kMostCorners, "a shape of more than 4096 corners");
  require(shape.radius_px >= 0 && shape.radius_px <= 1e4, "a brush of no size");
  low_ = high_ = shape.path_px[0];
  for (const Vec2& p : shape.path_px) {
    require(p.allFinite() && p.cwiseAbs().maxCoeff() <= 1e6, "a corner that is not finite");
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
  low_.array() -= shape.radius_px;
  high_.array() += shape.radius_px;
  const Vec2 size = high_ - low_;
  cell_ = std::max(1.0, size.maxCoeff() / kMostCells);
  columns_ = int(size.x() / cell_) + 1;
  rows_ = int(size.y() / cell_) + 1;
  fill();
}

double ScreenShape::distance2(double x, double y) const {
  const auto& path = shape_.path_px;
  const Vec2 p(x, y);
  double nearest = (p - path[0]).squaredNorm();
  for (size_t k = 1; k < path.size(); ++k) {
    nearest = std::min(nearest, squared_distance(p, path[k - 1], path[k]));
  }
  if (shape_.radius_px > 0) return nearest;
  return std::min(nearest, squared_distance(p, path.back(), path.front()));
}

bool ScreenShape::exactly(double x, double y) const {
  if (shape_.radius_px > 0) return distance2(x, y) <= shape_.radius_px * shape_.radius_px;
  const auto& path = shape_.path_px;
  bool inside = false;
  for (size_t k = 0, last = path.size() - 1; k < path.size(); last = k++) {
    const Vec2 &a = path[k], &b = path[last];
    if ((a.y() > y) == (b.y() > y)) continue;
    if (x < a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

void ScreenShape::fill() {
  mask_.resize(size_t(columns_) * size_t(rows_));
  inside_.assign(size_t(columns_ + 1) * size_t(rows_ + 1), 0);
  const double half = cell_ * std::sqrt(0.5) * (1 + 1e-9);
  const double r = shape_.radius_px;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const double x = low_.x() + (column + 0.5) * cell_, y = low_.y() + (row + 0.5) * cell_;
      // The outline of a brush lies at its radius from the path, that of a polygon on the path.
      const double from_outline = std::abs(std::sqrt(distance2(x, y)) - r);
      Cell& cell = mask_[size_t(row) * size_t(columns_) + size_t(column)];
      cell = from_outline <= half ? Cell::kBoundary
             : exactly(x, y)      ? Cell::kInside
                                  : Cell::kOutside;
      const size_t above = size_t(row) * size_t(columns_ + 1) + size_t(column);
      const size_t below = above + size_t(columns_ + 1);
      inside_[below + 1] =
          inside_[above + 1] + inside_[below] - inside_[above] + (cell == Cell::kInside ? 1u : 0u);
    }
  }
}

ScreenPoint ScreenShape::project(const Vec3& point) const {
  const Eigen::Vector4d clip = shape_.clip_from_point * point.homogeneous();
  const double w = clip.w();
  if (!(w > 0)) return {0, 0, 0};
  return {(clip.x() / w + 1) * 0.5 * shape_.width_px, (1 - clip.y() / w) * 0.5 * shape_.height_px,
          w};
}

bool ScreenShape::contains(double x, double y) const {
  if (!(x >= low_.x() && y >= low_.y() && x <= high_.x() && y <= high_.y())) return false;
  const int column = std::min(int((x - low_.x()) / cell_), columns_ - 1);
  const int row = std::min(int((y - low_.y()) / cell_), rows_ - 1);
  const Cell cell = mask_[size_t(row) * size_t(columns_) + size_t(column)];
  return cell == Cell::kBoundary ? exactly(x, y) : cell == Cell::kInside;
}

ScreenShape::Overlap ScreenShape::overlap(const Vec3& low, double side) const {
  Vec2 from = Vec2::Constant(std::numeric_limits<double>::infinity()), to = -from;
  int behind = 0;
  for (int k = 0; k < 8; ++k) {
    const ScreenPoint p = project(low + side * Vec3(k & 1, k >> 1 & 1, k >> 2));
    if (p.depth_m <= 0) ++behind;
    from = from.cwiseMin(Vec2(p.x, p.y));
    to = to.cwiseMax(Vec2(p.x, p.y));
  }
  if (behind == 8) return Overlap::kNone;
  if (behind > 0) return Overlap::kSome;
  if (to.x() < low_.x() || to.y() < low_.y() || from.x() > high_.x() || from.y() > high_.y()) {
    return Overlap::kNone;
  }
  // Whole if all cells of the rectangle around the cube, and some more for rounding, are inside.
  const Vec2 a = (from - low_) / cell_ - Vec2(0.01, 0.01),
             b = (to - low_) / cell_ + Vec2(0.01, 0.01);
  if (a.x() < 0 || a.y() < 0 || b.x() >= columns_ || b.y() >= rows_) return Overlap::kSome;
  const size_t c0 = size_t(a.x()), r0 = size_t(a.y()), c1 = size_t(b.x()) + 1,
               r1 = size_t(b.y()) + 1;
  const auto sum = [&](size_t row, size_t column) {
    return uint64_t(inside_[row * size_t(columns_ + 1) + column]);
  };
  const uint64_t inner = sum(r1, c1) + sum(r0, c0) - sum(r0, c1) - sum(r1, c0);
  return inner == (c1 - c0) * (r1 - r0) ? Overlap::kWhole : Overlap::kSome;
}

}  // namespace underbrush::serve
