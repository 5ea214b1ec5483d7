#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/ground/plane_grid.hpp"
#include "underbrush/ground/segment.hpp"

namespace underbrush::ground {
namespace {

constexpr double kPriorWeight = 3;  // Weight of the prior, in numbers of low points.
constexpr double kBelow = 4;        // Weight of a low point that lies well below the surface.
constexpr double kFar2 = 9.21;  // (residual / s)² from which on a low point has no weight: 1e-4.
constexpr uint32_t kNoCell = std::numeric_limits<uint32_t>::max();

/// The points sorted by the finest cell that they lie in; x and y count from the tile's lower
/// corner.
struct SortedTile {
  int nx = 0, ny = 0;
  double cell_m = 0;
  std::vector<Vec3f> points;
  std::vector<uint32_t> source;  ///< Index of each point in the caller's points.
  std::vector<uint32_t> start;   ///< First point of each cell; one entry more marks the end.

  std::span<Vec3f> cell(size_t c) { return {points.data() + start[c], start[c + 1] - start[c]}; }
};

SortedTile sort_by_cell(std::span<const Vec3f> points, double cell_m) {
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
  for (const Vec3f& p : points) {
    if (!p.allFinite()) continue;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  SortedTile tile;
  tile.cell_m = cell_m;
  if (!(low.x() <= high.x())) return tile;
  const double nx = std::floor(double(high.x() - low.x()) / cell_m) + 1;
  const double ny = std::floor(double(high.y() - low.y()) / cell_m) + 1;
  require_data(nx * ny <= double(1 << 26), "lower envelope: the tile exceeds 2^26 cells");
  tile.nx = int(nx);
  tile.ny = int(ny);
  std::vector<uint32_t> cell_of(points.size());
  parallel_for(points.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (!points[i].allFinite()) {
        cell_of[i] = kNoCell;
        continue;
      }
      const int x = std::min(tile.nx - 1, int(double(points[i].x() - low.x()) / cell_m));
      const int y = std::min(tile.ny - 1, int(double(points[i].y() - low.y()) / cell_m));
      cell_of[i] = uint32_t(y * tile.nx + x);
    }
  });
  tile.start.assign(size_t(tile.nx) * tile.ny + 1, 0);
  for (uint32_t c : cell_of) {
    if (c != kNoCell) ++tile.start[c + 1];
  }
  for (size_t c = 1; c < tile.start.size(); ++c) tile.start[c] += tile.start[c - 1];
  tile.points.resize(tile.start.back());
  tile.source.resize(tile.start.back());
  std::vector<uint32_t> next(tile.start.begin(), tile.start.end() - 1);
  for (size_t i = 0; i < points.size(); ++i) {
    if (cell_of[i] == kNoCell) continue;
    const uint32_t to = next[cell_of[i]]++;
    tile.points[to] = Vec3f(points[i].x() - low.x(), points[i].y() - low.y(), points[i].z());
    tile.source[to] = uint32_t(i);
  }
  return tile;
}

/// Refits `grid`, which holds the prior, in place to points sorted by finest cell. `row_start[r]`
/// is the first point of finest row r. A point counts with the weight `weight(residual)`.
template <class Weight>
void refit(PlaneGrid& grid, int level, const std::vector<Vec3f>& points,
           const std::vector<uint32_t>& row_start, const Weight& weight) {
  const double c = grid.cell_m;
  const int fine_rows = int(row_start.size()) - 1;
  std::vector<PlaneMoments> moments(grid.planes.size());
  parallel_for(size_t(grid.ny), 4, [&](size_t begin, size_t end) {
    const int first = int(begin) << level, last = std::min(fine_rows, int(end) << level);
    for (uint32_t i = row_start[first]; i < row_start[last]; ++i) {
      const double x = points[i].x(), y = points[i].y(), z = points[i].z();
      const double w = weight(z - grid.at(x, y).h);
      if (w == 0) continue;
      const int cx = std::min(grid.nx - 1, int(x / c));
      const int cy = std::clamp(int(y / c), int(begin), int(end) - 1);
      moments[size_t(cy) * grid.nx + cx].add(x - (cx + 0.5) * c, y - (cy + 0.5) * c, z, w);
    }
  });
  std::vector<PlaneGrid::Plane> fitted(grid.planes.size());
  parallel_for(size_t(grid.ny), 4, [&](size_t begin, size_t end) {
    constexpr double kKernel[3] = {0.5, 1, 0.5};
    for (int j = int(begin); j < int(end); ++j) {
      for (int i = 0; i < grid.nx; ++i) {
        PlaneMoments sum;
        for (int dj = std::max(-1, -j); dj <= std::min(1, grid.ny - 1 - j); ++dj) {
          for (int di = std::max(-1, -i); di <= std::min(1, grid.nx - 1 - i); ++di) {
            const PlaneMoments& m = moments[size_t(j + dj) * grid.nx + i + di];
            if (m.w > 0) sum.add(m, di * c, dj * c, kKernel[di + 1] * kKernel[dj + 1]);
          }
        }
        const size_t at = size_t(j) * grid.nx + i;
        fitted[at] = sum.w > 0 ? fit_plane(sum, grid.planes[at], kPriorWeight, c) : grid.planes[at];
      }
    }
  });
  grid.planes.swap(fitted);
}

/// The low point of each occupied cell, ordered by cell, without pits.
struct LowPoints {
  std::vector<Vec3f> points;
  std::vector<uint32_t> row_start;
};

LowPoints low_points(SortedTile& tile, double quantile) {
  const float kNone = std::numeric_limits<float>::infinity();
  std::vector<Vec3f> low(size_t(tile.nx) * tile.ny, Vec3f::Constant(kNone));
  parallel_for(size_t(tile.ny), 4, [&](size_t begin, size_t end) {
    std::vector<Vec3f> copy;
    for (size_t c = begin * tile.nx; c < end * tile.nx; ++c) {
      const std::span<Vec3f> cell = tile.cell(c);
      if (cell.empty()) continue;
      copy.assign(cell.begin(), cell.end());
      const auto at = copy.begin() + ptrdiff_t(quantile * double(copy.size()));
      std::nth_element(copy.begin(), at, copy.end(),
                       [](const Vec3f& a, const Vec3f& b) { return a.z() < b.z(); });
      low[c] = *at;
    }
  });
  constexpr int kReach = 3;       // cells
  constexpr float kDepth = 0.5f;  // m
  std::vector<uint8_t> pit(low.size());
  parallel_for(size_t(tile.ny), 4, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y) {
      for (int x = 0; x < tile.nx; ++x) {
        const Vec3f& p = low[size_t(y) * tile.nx + x];
        if (p.z() == kNone) continue;
        int others = 0, shared = 0;
        const int v1 = std::min(tile.ny - 1, y + kReach), u1 = std::min(tile.nx - 1, x + kReach);
        for (int v = std::max(0, y - kReach); v <= v1 && shared < 2; ++v) {
          for (int u = std::max(0, x - kReach); u <= u1; ++u) {
            const Vec3f& q = low[size_t(v) * tile.nx + u];
            if (q.z() == kNone || (u == x && v == y)) continue;
            ++others;
            shared += q.z() - p.z() < kDepth + 0.5f * (q - p).head<2>().norm();
          }
        }
        pit[size_t(y) * tile.nx + x] = others >= 4 && shared < 2;
      }
    }
  });
  LowPoints result;
  for (int y = 0; y < tile.ny; ++y) {
    result.row_start.push_back(uint32_t(result.points.size()));
    for (size_t c = size_t(y) * tile.nx; c < size_t(y + 1) * tile.nx; ++c) {
      if (low[c].z() != kNone && !pit[c]) result.points.push_back(low[c]);
    }
  }
  result.row_start.push_back(uint32_t(result.points.size()));
  return result;
}

/// Makes a first guess on the coarsest cells: a low quantile of the low points, cut so that it
/// rises by no more than `slope` from any other cell.
PlaneGrid first_guess(const SortedTile& tile, int level, const LowPoints& low, double slope) {
  PlaneGrid grid(tile.nx, tile.ny, tile.cell_m, level);
  std::vector<std::vector<float>> heights(grid.planes.size());
  for (const Vec3f& p : low.points) {
    const int x = std::min(grid.nx - 1, int(p.x() / grid.cell_m));
    const int y = std::min(grid.ny - 1, int(p.y() / grid.cell_m));
    heights[size_t(y) * grid.nx + x].push_back(p.z());
  }
  for (size_t c = 0; c < heights.size(); ++c) {
    std::vector<float>& h = heights[c];
    grid.planes[c].h = std::numeric_limits<double>::infinity();
    if (h.empty()) continue;
    const auto at = h.begin() + ptrdiff_t(0.1 * double(h.size()));
    std::nth_element(h.begin(), at, h.end());
    grid.planes[c].h = *at;
  }
  // These are two sweeps of the chamfer distance transform: h(c) = min over c' of h(c') + slope |c
  // − c'|.
  const double step = slope * grid.cell_m;
  const auto relax = [&](int x, int y, int dx, int dy) {
    if (x + dx < 0 || x + dx >= grid.nx || y + dy < 0 || y + dy >= grid.ny) return;
    double& h = grid.planes[size_t(y) * grid.nx + x].h;
    h = std::min(h, grid.planes[size_t(y + dy) * grid.nx + x + dx].h + step * std::hypot(dx, dy));
  };
  constexpr std::array<std::array<int, 2>, 4> kBefore{{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  for (int y = 0; y < grid.ny; ++y) {
    for (int x = 0; x < grid.nx; ++x) {
      for (const auto& d : kBefore) relax(x, y, d[0], d[1]);
    }
  }
  for (int y = grid.ny; y-- > 0;) {
    for (int x = grid.nx; x-- > 0;) {
      for (const auto& d : kBefore) relax(x, y, -d[0], -d[1]);
    }
  }
  return grid;
}

/// Returns the smooth lower envelope on the finest cells.
PlaneGrid envelope(SortedTile& tile, const LowerEnvelopeOptions& o) {
  const LowPoints low = low_points(tile, o.low_quantile);
  int level = 0;
  while (o.cell_m * (2 << level) <= o.coarsest_m * 1.001) ++level;
  PlaneGrid grid = first_guess(tile, level, low, o.slope);
  const int coarsest = level;
  for (;; --level) {
    // A plane of a large cell misses curved ground by about cell²; vegetation demands a smaller
    // tolerance. A level therefore starts with twice its tolerance and ends with once; after the
    // rough first guess it starts with four times.
    for (double wide = level == coarsest ? 4 : 2; wide >= 1; wide /= level == coarsest ? 1.5 : 2) {
      const double s = std::max(o.band_m, wide * o.bend * std::pow(grid.cell_m, 1.5));
      const auto weight = [s](double r) {
        const double q2 = r * r / (s * s);
        if (r <= 0) return 1 + (kBelow - 1) * std::min(1.0, q2);
        return q2 < kFar2 ? std::exp(-q2) : 0.0;
      };
      refit(grid, level, low.points, low.row_start, weight);
    }
    if (level == 0) break;
    PlaneGrid finer(tile.nx, tile.ny, tile.cell_m, level - 1);
    for (int y = 0; y < finer.ny; ++y) {
      for (int x = 0; x < finer.nx; ++x) {
        finer.planes[size_t(y) * finer.nx + x] =
            grid.at((x + 0.5) * finer.cell_m, (y + 0.5) * finer.cell_m);
      }
    }
    grid = std::move(finer);
  }
  return grid;
}

/// The height of each point above the surface, along its normal, m.
std::vector<float> heights_above(const PlaneGrid& surface, const std::vector<Vec3f>& points) {
  std::vector<float> height(points.size());
  parallel_for(points.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3f& p = points[i];
      const PlaneGrid::Plane at = surface.at(p.x(), p.y());
      height[i] = float((p.z() - at.h) / std::sqrt(1 + at.gx * at.gx + at.gy * at.gy));
    }
  });
  return height;
}

/// Counts of the heights of points about the surface, in bins of 2.5 cm.
class HeightHistogram {
 public:
  void add(float height_m) {
    const float bin = std::floor((height_m - kLowestM) / kBinM);
    if (bin >= 0 && bin < kBins) ++count_[size_t(bin)];
  }
  void add(const HeightHistogram& other) {
    for (size_t b = 0; b < kBins; ++b) count_[b] += other.count_[b];
  }

  /// Whether the densest 10 cm near the surface are at least `least` times as dense as the 15 cm
  /// above them.
  bool has_layer(double least) const {
    int densest = 0;
    for (int b = 1; b + kLayerBins + kAboveBins <= kBins; ++b) {
      if (sum(b, kLayerBins) > sum(densest, kLayerBins)) densest = b;
    }
    // Few points are no evidence against a layer.
    constexpr double kPriorPoints = 4;
    const double within = kPriorPoints + sum(densest, kLayerBins);
    return within * kAboveBins >= least * sum(densest + kLayerBins, kAboveBins) * kLayerBins;
  }

 private:
  static constexpr int kBins = 15, kLayerBins = 4, kAboveBins = 6;
  static constexpr float kBinM = 0.025f, kLowestM = -0.1f;

  uint32_t sum(int begin, int n) const {
    return std::accumulate(&count_[size_t(begin)], &count_[size_t(begin)] + n, 0u);
  }

  std::array<uint32_t, kBins> count_{};
};

/// Whether the points about each of the finest cells form a layer, as `LowerEnvelopeOptions::layer`
/// demands.
std::vector<uint8_t> layers(const SortedTile& tile, const std::vector<float>& height,
                            double least) {
  const size_t cells = tile.start.size() - 1;
  std::vector<HeightHistogram> of_cell(cells);
  parallel_for(cells, 1 << 10, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      for (uint32_t i = tile.start[c]; i < tile.start[c + 1]; ++i) of_cell[c].add(height[i]);
    }
  });
  std::vector<uint8_t> out(cells);
  const auto histogram_about = [&](int x, int y) {
    HeightHistogram histogram;
    for (int v = std::max(0, y - 1); v <= std::min(tile.ny - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(tile.nx - 1, x + 1); ++u) {
        histogram.add(of_cell[size_t(v) * tile.nx + u]);
      }
    }
    return histogram;
  };
  parallel_for(size_t(tile.ny), 4, [&](size_t begin, size_t end) {
    for (int y = int(begin); y < int(end); ++y) {
      for (int x = 0; x < tile.nx; ++x) {
        const size_t c = size_t(y) * tile.nx + x;
        if (tile.start[c] < tile.start[c + 1]) out[c] = histogram_about(x, y).has_layer(least);
      }
    }
  });
  return out;
}

}  // namespace

std::vector<uint8_t> lower_envelope(std::span<const Vec3f> points, const LowerEnvelopeOptions& o) {
  require(
      o.cell_m > 0 && o.coarsest_m >= o.cell_m && o.slope > 0 && o.band_m > 0 && o.above_m > 0 &&
          o.below_m > 0 && o.layer >= 0 && o.low_quantile >= 0 && o.low_quantile < 1,
      "lower envelope: parameters must be positive, coarsest_m at least cell_m, the quantile in "
      "[0, 1)");
  std::vector<uint8_t> ground(points.size());
  SortedTile tile = sort_by_cell(points, o.cell_m);
  if (tile.points.empty()) return ground;
  const std::vector<float> height = heights_above(envelope(tile, o), tile.points);
  const std::vector<uint8_t> is_layer = layers(tile, height, o.layer);
  parallel_for(is_layer.size(), 1 << 10, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      for (uint32_t i = tile.start[c]; i < tile.start[c + 1]; ++i) {
        ground[tile.source[i]] = is_layer[c] && height[i] < o.above_m && height[i] > -o.below_m;
      }
    }
  });
  return ground;
}

}  // namespace underbrush::ground
