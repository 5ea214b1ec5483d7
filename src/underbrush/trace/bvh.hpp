/// \file
/// The bounding volume hierarchy: eight children a node, leaves of at most eight elements of one
/// kind, laid out for vector instructions.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::trace {

/// A child reference: an inner node's index, or kLeaf | (kTriangles) | block index.
inline constexpr uint32_t kLeaf = 0x80000000u, kTriangles = 0x40000000u, kIndexMask = 0x3fffffffu;
inline constexpr int kWidth = 8;

/// Boxes of eight children: lo[axis][child], hi[axis][child]; unused children are inverted boxes.
struct alignas(64) Node {
  float lo[3][kWidth], hi[3][kWidth];
  uint32_t child[kWidth];
  uint32_t unused[kWidth];
};

/// Eight ellipsoids: |U (x − mean)| ≤ 1 on the surface at Mahalanobis distance τ, U upper
/// triangular (u00 u01 u02 u11 u12 u22). Lanes without an ellipsoid are NaN and never met.
struct alignas(32) EllipsoidBlock {
  float mean[3][kWidth];
  float u[6][kWidth];
  uint32_t accept_below[kWidth];  ///< Accepted iff hash < this, or always where 0xffffffff.
  uint32_t element[kWidth];
};

/// Eight triangles by their corners; lanes without one are NaN.
struct alignas(32) TriangleBlock {
  float corner[3][3][kWidth];  ///< corner[vertex][axis][lane]
  uint32_t accept_below[kWidth];
  uint32_t element[kWidth];
};

/// The hierarchy over all elements of a model; coordinates relative to the model's origin.
struct Bvh {
  std::vector<Node> nodes;
  std::vector<EllipsoidBlock> ellipsoids;
  std::vector<TriangleBlock> triangles;
  uint32_t root = kLeaf | kIndexMask;  ///< kLeaf | kIndexMask: nothing at all.

  size_t bytes() const;
};

/// Builds by binned surface-area splits straight to eight children. Element numbers are the
/// model's.
Bvh build_bvh(const elements::Model& model);

}  // namespace underbrush::trace
