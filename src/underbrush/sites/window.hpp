/// \file
/// The area of a site in which its objects stand.
#pragma once
#include <span>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush {
/// Sites that are generated: the places and sizes of objects, and the ground below them.
namespace sites {

/// A part of the plane, as square cells of about a metre, at most 4096 along a side.
class Window {
 public:
  /// Takes the cells whose corners lie on the ground mesh and at least `margin_m` (m) inside of its
  /// bounding box. There may be none. Throws `std::invalid_argument` for a negative margin.
  explicit Window(const primitives::GroundSurface& ground, double margin_m = 0);

  /// Keeps only the area that the objects cover, without the ground beyond them that is not
  /// annotated: the cells within 10 m of an object, or within 1.5 times the 95 % quantile of the
  /// distances of objects to their nearest neighbours if that is more. Where this area ends on the
  /// ground, it is made narrower by that distance less half of the mean one. `at` are the places of
  /// the objects (m, world); without any the window stays as it is.
  void keep_around(std::span<const Eigen::Vector2d> at);

  bool is_empty() const { return cells_.empty(); }
  double area_m2() const { return double(cells_.size()) * cell_m_ * cell_m_; }
  double cell_m() const { return cell_m_; }
  /// Whether a place (m, world) lies in a cell of the window.
  bool contains(const Eigen::Vector2d& at) const;
  /// Returns a place that is distributed evenly over the window, which is not empty.
  Eigen::Vector2d draw(Stream& random) const;
  /// Returns the coordinates of a place relative to the bounds of the window: −1 to 1 along x and
  /// y.
  Eigen::Vector2d relative(const Eigen::Vector2d& at) const;
  /// Returns the bounding box of the window (m, world).
  const Eigen::AlignedBox2d& bounds() const { return bounds_; }
  /// Returns the middles of the cells (m, world), by rows.
  std::vector<Eigen::Vector2d> middles() const;

 private:
  struct Index {
    int x, y;
  };
  Index index_of(const Eigen::Vector2d& at) const;
  uint8_t* cell(const Index& i);
  void mark_disc(const Eigen::Vector2d& at, double radius_m, uint8_t from, uint8_t to);
  void collect();

  Eigen::Vector2d corner_;
  double cell_m_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<uint8_t> inside_;
  std::vector<uint32_t> cells_;
  Eigen::AlignedBox2d bounds_;
};

}  // namespace sites
}  // namespace underbrush
