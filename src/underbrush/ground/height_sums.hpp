/// \file
/// The normal equations that ground points contribute to a height map.
#pragma once
#include <array>
#include <map>
#include <span>

#include "underbrush/core/pose.hpp"
#include "underbrush/ground/height_grid_options.hpp"
#include "underbrush/ground/node_mask.hpp"

namespace underbrush::ground {

/// The couplings of half a row of the symmetric matrix: a node's coefficients with itself and with
/// the nodes that follow it row by row. Points contribute to the first five, bending to all seven.
enum Coupling { kSelf, kEast, kNorth, kNorthEast, kNorthWest, kEast2, kNorth2, kCouplings };
/// Number of the couplings that points contribute to.
inline constexpr int kPointCouplings = 5;
/// Step from a node to the node that it is coupled with.
inline constexpr int kStep[kCouplings][2] = {{0, 0},  {1, 0}, {0, 1}, {1, 1},
                                             {-1, 1}, {2, 0}, {0, 2}};

/// Returns the coupling that leads by (dx, dy); dy > 0, or dy = 0 and dx ≥ 0. It is −1 if there is
/// none.
constexpr int coupling_of(int dx, int dy) {
  for (int c = 0; c < kCouplings; ++c) {
    if (kStep[c][0] == dx && kStep[c][1] == dy) return c;
  }
  return -1;
}

/// Normal equations of the points at one node: Σ w wᵀ and Σ w z, where w are the bilinear weights
/// of a point's four nodes and z (m) counts from the origin.
struct NodeSums {
  double a[kPointCouplings] = {}, b = 0;
  void operator+=(const NodeSums& o) {
    for (int c = 0; c < kPointCouplings; ++c) a[c] += o.a[c];
    b += o.b;
  }
};

/// The sums of a block's cells reach one node beyond the block to the north and to the east.
inline constexpr int kSumSide = kBlockSide + 1;
/// Returns the place of the sums of the node (x, y) of a block.
inline size_t place_in_sums(int x, int y) { return size_t(y) * kSumSide + size_t(x); }
using BlockSums = std::array<NodeSums, kSumSide * kSumSide>;

/// The sums of all points.
struct HeightSums {
  Vec3 origin;                ///< m, world: node (0, 0).
  HeightGridOptions options;  ///< `spacing_m` is that of the nodes here.
  std::map<BlockKey, BlockSums> blocks;
  size_t n = 0;          ///< Number of points.
  double z = 0, zz = 0;  ///< Σ z (m) and Σ z² (m²).

  /// Adds points (m, world); see `HeightGrid::add`.
  void add(std::span<const Vec3> points);
  /// Adds the sums of `other`, which has the same origin and options.
  void merge(const HeightSums& other);

  /// Returns the number of cells that points lie in; a point on a cell's edge counts for none.
  size_t cells() const;
  /// Returns the sums for nodes twice as far apart. They are exact, because a coarse grid's
  /// bilinear functions are sums of the fine grid's.
  HeightSums coarsened() const;
  /// Returns the nodes that exist: those near points, and those in gaps that a closing by half of
  /// `bridge_m` fills.
  NodeMask nodes() const;
};

}  // namespace underbrush::ground
