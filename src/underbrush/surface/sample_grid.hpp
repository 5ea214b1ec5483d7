/// \file
/// This file has a dense grid of cells with thinned, oriented points of a tile, for neighbour
/// queries.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/surface/implicit.hpp"

namespace underbrush::surface {

/// A box of cells, [first, first + size) along each axis. Cell 0 begins at coordinate 0.
struct CellBox {
  std::array<int, 3> first{}, size{};

  bool empty() const { return size[0] == 0; }
  /// The number of cells; a double, because it may exceed any integer type.
  double count() const { return double(size[0]) * size[1] * size[2]; }
};

/// Samples of a tile's points, with at most one sample for each half cell. `find_normals` gives
/// them normals and radii and sorts them, so that the samples whose radius reaches a place are
/// found quickly.
class SampleGrid {
 public:
  /// Averages the points in each half cell within `box`. Positions and directions are summed as
  /// integers, so that the result has the same bits for any order of the points. `points` and
  /// `cell_m` are in metres; `to_sensor` are directions towards the sensor.
  SampleGrid(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor, const CellBox& box,
             double cell_m);

  /// Computes the radius and the normal of each sample. The radius is the first of `radii_m` (m,
  /// rising) within which at least `min_neighbours` samples, itself included, spread over a plane
  /// and not only along a line. The normal is that of this plane, turned towards the sensor.
  /// Samples without such a radius are dropped.
  void find_normals(std::span<const double> radii_m, int min_neighbours);

  /// Calls `visit(sample)` for each sample that is nearer to `x` (m) than its own radius. The order
  /// does not depend on the tile.
  template <class Visit>
  void reaching(const Vec3f& x, const Visit& visit) const;

  /// The oriented samples that have the same radius.
  struct Level {
    float radius_m = 0;
    CellBox box;                         ///< Cells as wide as the radius.
    std::vector<uint32_t> start;         ///< Begin of each cell's samples.
    std::vector<OrientedPoint> samples;  ///< Sorted by cell.
  };
  const std::vector<Level>& levels() const { return levels_; }

 private:
  template <class Visit>
  void near(const Vec3f& x, float radius_m, const Visit& visit) const;
  void sort_levels(std::span<const double> radii_m);

  CellBox box_;
  double cell_m_;
  std::vector<uint32_t> start_;
  std::vector<OrientedPoint> samples_;
  std::vector<Level> levels_;
};

/// Calls `visit(sample)` for each sample of a dense grid of cells (x fastest) that is nearer to `x`
/// than `radius_m` (m). `samples[start[c]]` is the first sample of cell c.
template <class Visit>
void for_each_near(const CellBox& box, double cell_m, std::span<const uint32_t> start,
                   std::span<const OrientedPoint> samples, const Vec3f& x, float radius_m,
                   const Visit& visit) {
  const auto cell_at = [&](float at) { return int(std::floor(double(at) / cell_m)); };
  std::array<int, 3> low{}, high{};
  for (size_t a = 0; a < 3; ++a) {
    low[a] = std::max(0, cell_at(x[int(a)] - radius_m) - box.first[a]);
    high[a] = std::min(box.size[a] - 1, cell_at(x[int(a)] + radius_m) - box.first[a]);
    if (low[a] > high[a]) return;
  }
  const float radius2 = radius_m * radius_m;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const size_t row = (size_t(k) * size_t(box.size[1]) + size_t(j)) * size_t(box.size[0]);
      const uint32_t end = start[row + size_t(high[0]) + 1];
      for (uint32_t s = start[row + size_t(low[0])]; s < end; ++s) {
        if ((samples[s].position - x).squaredNorm() < radius2) visit(samples[s]);
      }
    }
  }
}

template <class Visit>
void SampleGrid::reaching(const Vec3f& x, const Visit& visit) const {
  for (const Level& level : levels_) {
    for_each_near(level.box, double(level.radius_m), level.start, level.samples, x, level.radius_m,
                  visit);
  }
}

}  // namespace underbrush::surface
