/// \file
/// Shapes that a person draws on the picture of a camera.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::serve {

/// A place on a picture, px.
using Vec2 = Eigen::Vector2d;

/// A drawn shape: a polygon, or the path of a brush.
struct DrawnShape {
  /// Clip coordinates of a point, as WebGL has them; the fourth is the depth along the view, m.
  Eigen::Matrix4d clip_from_point = Eigen::Matrix4d::Identity();
  double width_px = 1, height_px = 1;  ///< Size of the picture.
  std::vector<Vec2> path_px;           ///< From the upper left corner.
  double radius_px = 0;                ///< Radius of the brush; 0 for a polygon (even-odd rule).
};

/// A point on the picture.
struct ScreenPoint {
  double x = 0, y = 0, depth_m = 0;
};

/// A drawn shape, prepared for many queries.
class ScreenShape {
 public:
  /// Throws `std::invalid_argument` for a shape that is not finite, has no size, has more than 4096
  /// corners, or a polygon with fewer than three.
  explicit ScreenShape(const DrawnShape& shape);

  /// The place of a point on the picture; a depth of 0 or less is behind the camera.
  ScreenPoint project(const Vec3& point) const;
  /// Whether a place of the picture is in the shape.
  bool contains(double x, double y) const;
  /// Whether a point that `project` found is in the shape, in front of the camera.
  bool contains(const ScreenPoint& p) const { return p.depth_m > 0 && contains(p.x, p.y); }

  /// The overlap of a cube with the shape.
  enum class Overlap { kNone, kSome, kWhole };
  /// Returns `kNone` and `kWhole` only where they are certain, for a cube with this lowest corner.
  Overlap overlap(const Vec3& low, double side) const;

  const Vec2& low_px() const { return low_; }
  const Vec2& high_px() const { return high_; }

 private:
  enum class Cell : uint8_t { kOutside, kInside, kBoundary };
  double distance2(double x, double y) const;
  bool exactly(double x, double y) const;
  void fill();

  DrawnShape shape_;
  Vec2 low_, high_;  ///< Bounds, px.
  double cell_ = 1;  ///< Side of a cell of the mask, px.
  int columns_ = 1, rows_ = 1;
  std::vector<Cell> mask_;
  std::vector<uint32_t> inside_;  ///< Number of inner cells left of and above a corner.
};

}  // namespace underbrush::serve
