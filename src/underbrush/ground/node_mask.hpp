/// \file
/// Sets of grid nodes, and those near them.
#pragma once
#include <vector>

#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

/// 1 for a node in the set, 0 for one that is not; a block that is absent holds none.
using NodeMask = BlockMap<uint8_t>;

/// The nodes within `radius` (in node spacings, Euclidean) of a node of the set.
NodeMask dilated(const NodeMask& mask, double radius);

/// The nodes of the set that are farther than `radius` from every node outside it.
NodeMask eroded(const NodeMask& mask, double radius);

/// The nodes in either set.
NodeMask united(const NodeMask& a, const NodeMask& b);

/// The square of nodes (i0 … i0 + side − 1, j0 … j0 + side − 1), row by row; `absent` where there
/// is no block.
template <class T>
std::vector<T> window(const BlockMap<T>& values, int i0, int j0, int side, T absent);

/// The same for a block and `halo` nodes around it.
template <class T>
std::vector<T> window(const BlockMap<T>& values, BlockKey key, int halo, T absent) {
  return window(values, key.x * kBlockSide - halo, key.y * kBlockSide - halo, kBlockSide + 2 * halo,
                absent);
}

}  // namespace underbrush::ground
