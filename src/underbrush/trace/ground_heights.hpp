/// \file
/// Heights of the ground of a model, also where the model has none.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/core/cells.hpp"
#include "underbrush/elements/observed_space.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// Heights of the ground, also beyond the ground that is known, where it goes on at the height of
/// its nearest part.
class GroundHeights {
 public:
  /// Uses the vertices of the mesh that `keep` selects, or all if `keep` is empty. `lost` are beams
  /// that were lost below the ground.
  GroundHeights(const elements::TriangleMesh& ground, const std::vector<bool>& keep,
                std::span<const elements::LostBeams> lost = {});
  /// Whether no ground is known at all.
  bool empty() const { return height_m_.empty(); }
  /// The height of the ground at a place, m; all in the frame of the mesh.
  double at(double x, double y) const { return between(height_m_, x, y); }
  /// Whether the mesh has ground in the square of a place.
  bool is_known(double x, double y) const {
    const Cell2 c = cell_of(x, y, side_m_);
    return has_ground(c.x - low_.x, c.y - low_.y);
  }
  /// The share of beams below the ground at a place that may return, by the beams that were lost
  /// near it: 1 where there are none.
  double share(double x, double y) const { return share_.empty() ? 1 : between(share_, x, y); }
  /// The range (m) at which a ray (frame of the mesh) first comes below the ground within limits,
  /// found in steps of `step_m`; empty where it does not.
  std::optional<double> entry(const Ray& ray, const RangeLimits& limits, double step_m) const;
  /// What the heights in an interval along an axis depend on: the first and last of the cells
  /// between whose middles they lie, and the cells in which the interval begins and ends.
  struct Interval {
    int32_t first, last, begin, end;
  };
  Interval along_x(double x, double length_m) const { return interval(x, length_m, low_.x, nx_); }
  Interval along_y(double y, double length_m) const { return interval(y, length_m, low_.y, ny_); }
  /// Bounds of the heights in a rectangle.
  std::array<double, 2> bounds(const Interval& x, const Interval& y) const;
  /// Whether the mesh has ground in all squares of a rectangle.
  bool is_known(const Interval& x, const Interval& y) const;
  double lowest_m() const { return lowest_m_; }
  double highest_m() const { return highest_m_; }

 private:
  /// Continues the values of the cells `front`, ring by ring: a cell takes the mean of its
  /// neighbours in the ring before.
  void extend(std::vector<float>& values, std::vector<size_t> front) const;
  bool has_ground(int32_t i, int32_t j) const {
    return i >= 0 && j >= 0 && i < nx_ && j < ny_ && known_[size_t(j) * size_t(nx_) + size_t(i)];
  }
  Interval interval(double at, double length_m, int32_t low, int32_t count) const;
  /// The value at a place, between the middles of cells.
  double between(const std::vector<float>& values, double x, double y) const;

  // The grid of cells has the side `side_m_`, the first cell `low_`, and nx_ by ny_ cells.
  double side_m_ = elements::ObservedSpace::kSquareM;
  Cell2 low_;
  int32_t nx_ = 0, ny_ = 0;
  std::vector<float> height_m_, share_;  // of the middles of cells; x fastest
  std::vector<uint8_t> known_;           // of cells
  double lowest_m_ = 0, highest_m_ = 0;
};

}  // namespace underbrush::trace
