/// \file
/// The normal equations of some points in little space, in which a `HeightGrid` gets the points of
/// a tile that is kept.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/ground/height_sums.hpp"

namespace underbrush::ground {

/// The sums of a `HeightSums` at the nodes that points affect, in order of blocks and of places in
/// them. Nothing is lost, so merging them gives the same bits as merging the `HeightSums`.
struct SparseSums {
  /// The sums of one node; `place` is that of `place_in_sums`.
  struct Node {
    BlockKey block;
    uint16_t place = 0;
    NodeSums sums;
  };
  size_t n = 0;          ///< Number of points.
  double z = 0, zz = 0;  ///< Σ z (m) and Σ z² (m²).
  std::vector<Node> nodes;
};

/// Leaves out the nodes that no point affects.
SparseSums sparse(const HeightSums& sums);

/// Adds the sums of points that have the origin and the options of `to`.
void merge(const SparseSums& from, HeightSums& to);

}  // namespace underbrush::ground
