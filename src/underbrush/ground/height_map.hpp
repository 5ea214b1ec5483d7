/// \file
/// Heights at the nodes of an unbounded regular grid, kept in blocks so that memory follows the
/// area that is covered and not its bounding box.
#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "underbrush/core/pose.hpp"

namespace underbrush::ground {

/// Nodes along a block's side.
inline constexpr int kBlockSide = 32;
inline constexpr int kBlockNodes = kBlockSide * kBlockSide;

/// Which block: nodes (32 x … 32 x + 31, 32 y … 32 y + 31). Ordered row by row.
struct BlockKey {
  int32_t y = 0, x = 0;
  auto operator<=>(const BlockKey&) const = default;
};

/// The block of node (i, j).
inline BlockKey block_of(int i, int j) { return {j >> 5, i >> 5}; }
/// Place of node (i, j) in its block, row by row.
inline int place_in_block(int i, int j) { return (j & 31) * kBlockSide + (i & 31); }

/// A value for each node of the blocks that exist.
template <class T>
using BlockMap = std::map<BlockKey, std::array<T, kBlockNodes>>;

/// A ground surface: node (i, j) lies at origin + (i s, j s, height). Between four nodes that exist
/// the surface is bilinear; elsewhere there is none.
struct HeightMap {
  Vec3 origin = Vec3::Zero();  ///< m, world.
  double spacing_m = 0.5;      ///< s.
  double sigma_m = 0;        ///< Root mean square vertical residual of the points it was fitted to.
  size_t points = 0;         ///< How many those were.
  BlockMap<double> height;   ///< m above the origin; meaningless where no node exists.
  BlockMap<uint8_t> exists;  ///< 1 where there is a node; the same blocks as `height`.

  /// Number of nodes.
  size_t size() const;
  bool has(int i, int j) const;
  /// Height of node (i, j), m above the origin; the node must exist.
  double node(int i, int j) const;
  /// World z at world (x, y), or nothing where the surface does not reach.
  std::optional<double> at(double x, double y) const;
};

}  // namespace underbrush::ground
