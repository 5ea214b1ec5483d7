/// \file
/// Thinned, oriented points of a tile in a dense grid of cells, for neighbour queries.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "underbrush/fit/surface.hpp"

namespace underbrush::fit {

/// Cells [first, first + size) along each axis, counted from zero at coordinate 0.
struct CellBox {
  std::array<int, 3> first{}, size{};

  size_t count() const { return size_t(size[0]) * size_t(size[1]) * size_t(size[2]); }
};

/// At most one sample for each half cell, sorted by cell.
class SampleGrid {
 public:
  /// Means of the points in each half cell, within `box`. Sums are of integers: the same bits for
  /// any order of the points.
  SampleGrid(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor, const CellBox& box,
             double cell_m);

  /// Replaces the direction to the sensor of each sample by the normal of the plane through the
  /// samples within `radius_m`, turned that way; drops samples with fewer than `min_neighbours`.
  void find_normals(double radius_m, int min_neighbours);

  const CellBox& box() const { return box_; }
  double cell_m() const { return cell_m_; }
  std::span<const OrientedPoint> cell(size_t c) const {
    return {samples_.data() + start_[c], start_[c + 1] - start_[c]};
  }
  std::span<const OrientedPoint> samples() const { return samples_; }

  /// Calls `visit(sample)` for each within `radius_m` of `x`, in an order that does not depend on
  /// the tile, until it returns false.
  template <class Visit>
  void near(const Vec3f& x, float radius_m, const Visit& visit) const;

 private:
  int cell_at(float coordinate) const;

  CellBox box_;
  double cell_m_;
  std::vector<uint32_t> start_;
  std::vector<OrientedPoint> samples_;
};

template <class Visit>
void SampleGrid::near(const Vec3f& x, float radius_m, const Visit& visit) const {
  std::array<int, 3> low{}, high{};
  for (size_t a = 0; a < 3; ++a) {
    low[a] = std::max(0, cell_at(x[int(a)] - radius_m) - box_.first[a]);
    high[a] = std::min(box_.size[a] - 1, cell_at(x[int(a)] + radius_m) - box_.first[a]);
    if (low[a] > high[a]) return;
  }
  const float radius2 = radius_m * radius_m;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const size_t row = (size_t(k) * size_t(box_.size[1]) + size_t(j)) * size_t(box_.size[0]);
      const uint32_t end = start_[row + size_t(high[0]) + 1];
      for (uint32_t s = start_[row + size_t(low[0])]; s < end; ++s) {
        if ((samples_[s].position - x).squaredNorm() > radius2) continue;
        if (!visit(samples_[s])) return;
      }
    }
  }
}

}  // namespace underbrush::fit
