/// \file
/// Heights at the nodes of an unbounded regular grid. They are kept in blocks, so that memory grows
/// with the area that is covered and not with its bounding box.
#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "underbrush/core/pose.hpp"

namespace underbrush::ground {

/// Number of nodes along the side of a block.
inline constexpr int kBlockSide = 32;
/// Number of nodes of a block.
inline constexpr int kBlockNodes = kBlockSide * kBlockSide;

/// Index of the block with the nodes (32 x … 32 x + 31, 32 y … 32 y + 31). Keys are ordered row by
/// row.
struct BlockKey {
  int32_t y = 0, x = 0;
  auto operator<=>(const BlockKey&) const = default;
};

/// Returns the block that holds node (i, j).
inline BlockKey block_of(int i, int j) { return {j >> 5, i >> 5}; }
/// Returns the place of node (i, j) in its block, row by row.
inline int place_in_block(int i, int j) { return (j & 31) * kBlockSide + (i & 31); }

/// A value for each node of the blocks that exist.
template <class T>
using BlockMap = std::map<BlockKey, std::array<T, kBlockNodes>>;

/// A ground surface whose node (i, j) lies at origin + (i s, j s, height). Between four nodes that
/// exist the surface is bilinear; elsewhere there is none.
struct HeightMap {
  Vec3 origin = Vec3::Zero();  ///< m, world.
  double spacing_m = 0.5;      ///< m; distance s of the nodes.
  double sigma_m = 0;  ///< m; root mean square of the vertical residuals of the points that it was
                       ///< fitted to.
  size_t points = 0;   ///< Number of points that it was fitted to.
  BlockMap<double> height;   ///< m above the origin; meaningless where no node exists.
  BlockMap<uint8_t> exists;  ///< 1 where there is a node; has the same blocks as `height`.

  /// Returns the number of nodes that exist.
  size_t size() const;
  bool has(int i, int j) const;
  /// Returns the height of node (i, j), m above the origin; the node must exist.
  double node(int i, int j) const;
  /// Returns the world z at world (x, y), or nothing where the surface does not reach.
  std::optional<double> at(double x, double y) const;
};

}  // namespace underbrush::ground
