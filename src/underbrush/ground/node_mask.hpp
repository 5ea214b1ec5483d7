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

/// The window of `values` that a block and `halo` nodes around it cover: (32 + 2 halo)² values, row
/// by row; `absent` where there is no block.
template <class T>
std::vector<T> window(const BlockMap<T>& values, BlockKey key, int halo, T absent);

}  // namespace underbrush::ground
