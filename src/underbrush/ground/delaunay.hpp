/// \file
/// Incremental Delaunay triangulation of the nodes of a square grid.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace underbrush::ground {

/// Delaunay triangulation of integer points in [0, side]² and of the four corners of a frame one
/// step around them. Its predicates are exact, so that grids, whose points lie on common circles
/// and lines, are no special case. The split of four points on one circle depends only on the order
/// of insertion. A point takes about a microsecond if it lies near the one before it.
class GridDelaunay {
 public:
  using Point = std::array<int, 2>;
  /// A triangle and its neighbours, by index.
  struct Triangle {
    std::array<uint32_t, 3> point;     ///< Indices of the corners, counter-clockwise.
    std::array<int32_t, 3> neighbour;  ///< The triangle across the side opposite to each corner;
                                       ///< −1: none.
  };

  /// Throws `std::invalid_argument` unless 0 < side ≤ 2¹⁴.
  explicit GridDelaunay(int side);

  /// Inserts a point, unless it is there already. Returns the triangles around it, which are those
  /// that changed.
  const std::vector<uint32_t>& insert(const Point& p);

  /// Returns the frame's corners (0–3), followed by the points in order of insertion.
  const std::vector<Point>& points() const { return points_; }
  /// Returns the triangles, which cover the frame.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  /// Whether a triangle touches no corner of the frame.
  static bool inner(const Triangle& t) {
    return t.point[0] > 3 && t.point[1] > 3 && t.point[2] > 3;
  }

 private:
  uint32_t locate(const Point& p) const;
  void link(int32_t triangle, uint32_t from, uint32_t to);
  bool flip(uint32_t t);

  int side_;
  std::vector<Point> points_;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> around_;
  uint32_t last_ = 0;
};

}  // namespace underbrush::ground
