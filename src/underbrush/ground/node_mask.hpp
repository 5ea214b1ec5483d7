/// \file
/// Sets of grid nodes, with dilation, erosion and union.
#pragma once
#include <vector>

#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

/// A set of nodes: 1 for a node in the set, else 0. An absent block holds none.
using NodeMask = BlockMap<uint8_t>;

/// Returns the nodes within `radius` (in node spacings, Euclidean) of a node of the set.
NodeMask dilated(const NodeMask& mask, double radius);

/// Returns the nodes of the set that are farther than `radius` from every node outside it.
NodeMask eroded(const NodeMask& mask, double radius);

/// Returns the nodes that are in either set.
NodeMask united(const NodeMask& a, const NodeMask& b);

/// Returns the values at the square of nodes (i0 … i0 + side − 1, j0 … j0 + side − 1), row by row;
/// `absent` where there is no block.
template <class T>
std::vector<T> window(const BlockMap<T>& values, int i0, int j0, int side, T absent);

/// Returns the values at the nodes of a block and of `halo` nodes around it, row by row; `absent`
/// where there is no block.
template <class T>
std::vector<T> window(const BlockMap<T>& values, BlockKey key, int halo, T absent) {
  return window(values, key.x * kBlockSide - halo, key.y * kBlockSide - halo, kBlockSide + 2 * halo,
                absent);
}

}  // namespace underbrush::ground
