/// \file
/// The bounding volume hierarchy over the elements of one model, laid out for vector instructions:
/// leaves of at most eight elements of one kind.
#pragma once
#include <cstdint>

#include "underbrush/elements/model.hpp"
#include "underbrush/trace/hierarchy.hpp"

namespace underbrush::trace {

/// What a leaf of a model's tree holds: bits 29 and 30 of its reference. (Leaves of the tree over
/// instances have no kind: they hold subtrees of models.)
enum class LeafKind : uint32_t {
  kEllipsoids = 0,
  /// Ellipsoids whose intersections and trials are always decided in double: voxels, and shapes too
  /// thin for floats.
  kCareful = 0x20000000u,
  kTriangles = 0x40000000u,
  kPathLength = 0x60000000u,  ///< Ellipsoids of path-length opacity.
};

/// The kind of the leaf behind a reference.
__attribute__((always_inline)) constexpr LeafKind leaf_kind(uint32_t reference) {
  return LeafKind(reference & kKindMask);
}
/// The reference of a leaf.
constexpr uint32_t leaf_reference(LeafKind kind, uint32_t index) {
  return kLeaf | uint32_t(kind) | index;
}

/// Eight ellipsoids: |U (x − mean)| ≤ 1 on the surface at Mahalanobis distance τ, U upper
/// triangular (u00 u01 u02 u11 u12 u22). Lanes without an ellipsoid are NaN and never met.
struct alignas(32) EllipsoidBlock {
  float mean[3][kWidth];
  float u[6][kWidth];
  union {
    uint32_t accept_below[kWidth];  ///< Accepted iff hash < this, or always where 0xffffffff.
    float depth[kWidth];            ///< `LeafKind::kPathLength`: κ √(2π) / τ.
  };
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
  HugeVector<Node> nodes;
  HugeVector<EllipsoidBlock> ellipsoids;
  HugeVector<TriangleBlock> triangles;
  uint32_t root = kEmpty;
  Box box;

  size_t bytes() const;
};

/// Element numbers are the model's. Ellipsoids are found wherever |U (x − mean)| ≤ 1 in exact
/// arithmetic, where U is the float nearest to the true factor; those of `LeafKind::kCareful`
/// leaves may be inflated.
Bvh build_bvh(const elements::Model& model);

}  // namespace underbrush::trace
