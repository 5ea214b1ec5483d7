/// \file
/// Delaunay triangulation of nodes of a square grid, node by node.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace underbrush::ground {

/// The Delaunay triangulation of integer points in [0, side]² and of the four corners of a frame
/// one step around them. Predicates are exact, so grids, whose points lie on common circles and
/// lines, are no special case; which way such points are split depends on the order of insertion
/// only. A point costs about a microsecond when near the one before it.
class GridDelaunay {
 public:
  using Point = std::array<int, 2>;
  struct Triangle {
    std::array<uint32_t, 3> point;     ///< Counter-clockwise.
    std::array<int32_t, 3> neighbour;  ///< Across the side opposite to each point; −1: none.
  };

  /// Throws `std::invalid_argument` unless 0 < side ≤ 2¹⁴.
  explicit GridDelaunay(int side);

  /// Inserts a point (nothing happens if it is there already). The triangles changed: those around
  /// it.
  const std::vector<uint32_t>& insert(const Point& p);

  /// The frame's corners (0–3), then the points in order of insertion.
  const std::vector<Point>& points() const { return points_; }
  /// Triangles that cover the frame.
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
