/// \file
/// This file estimates the box of an object from the points that were measured on it.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// The options of `ShapeFitter`.
struct ShapeOptions {
  int coarse_headings = 18;  ///< Headings of a quarter turn that are tried first.
  int fine_headings = 10;    ///< Headings tried between the best one's neighbours.
  /// m; a point nearer to a side than this counts as if it were so far away (d₀).
  double least_distance_m = 0.05;
  /// Most points of the outline; 0 = all points are used.
  size_t outline = 96;
  /// A segment with fewer points has no heading.
  size_t heading_points = 5;
  /// m; a segment of a smaller horizontal extent has no heading.
  double heading_extent_m = 1.0;

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The shape of a segment for a given heading.
struct SegmentShape {
  OrientedBox box;                          ///< Around the points, in the frame of the points.
  Vec3 centre_of_gravity_m = Vec3::Zero();  ///< The mean of the points.
  /// The place from which the points were seen, in the frame of the box, from its centre.
  Vec3 viewpoint_m = Vec3::Zero();
  uint32_t points = 0;
  /// The larger horizontal extent.
  double extent_m() const { return std::max(box.size_m.x(), box.size_m.y()); }
};

/// Finds the heading and the extents of segments. It keeps its memory from one call to the next.
class ShapeFitter {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit ShapeFitter(const ShapeOptions& options = {});

  /// Searches the heading of an L-shaped segment, by the closeness criterion of [zhang17] (Alg. 2
  /// and 4): of all headings it takes the one for which the points are nearest to two perpendicular
  /// sides of the rectangle around them, as Σ 1 / max(d_i, d₀). Returns the heading modulo a
  /// quarter turn, in [0, π/2); nothing for a segment that is too small to have one.
  ///
  /// A segment of many points is reduced to its outline: the nearest point of each of `outline`
  /// equal steps of the tangent of the bearing, seen from `viewpoint`.
  std::optional<double> heading(std::span<const Vec3> points, const Vec3& viewpoint);

  /// Measures the box with the direction `yaw_rad` around points. There must be a point.
  static SegmentShape measure(std::span<const Vec3> points, double yaw_rad, const Vec3& viewpoint);

 private:
  double closeness(double heading_rad);
  void make_outline(std::span<const Vec3> points, const Vec3& viewpoint);

  ShapeOptions options_;
  std::vector<float> x_, y_, nearest_, along_, across_;
};

/// Turns a heading by quarter turns until it is as near to `hint_rad` as possible; the result is in
/// [−π, π).
double nearest_quarter(double heading_rad, double hint_rad);

}  // namespace underbrush::perception
