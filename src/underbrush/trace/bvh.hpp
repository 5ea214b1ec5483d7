/// \file
/// The bounding volume hierarchy over the elements of one model, laid out for vector instructions:
/// leaves of at most eight elements of one kind.
#pragma once
#include <cstdint>

#include "underbrush/elements/model.hpp"
#include "underbrush/trace/hierarchy.hpp"

namespace underbrush::trace {

/// What a leaf holds (bits 29 and 30 of its reference).
inline constexpr uint32_t kEllipsoids = 0;
/// Ellipsoids whose meetings and trials are decided in double, always: voxels, shapes too thin for
/// floats.
inline constexpr uint32_t kCareful = 0x20000000u;
inline constexpr uint32_t kTriangles = 0x40000000u;
/// Ellipsoids of path-length opacity.
inline constexpr uint32_t kPathLength = 0x60000000u;
/// Of the tree over instances, which has no elements: an entry of `SceneTree::entries`.
inline constexpr uint32_t kInstance = 0x60000000u;

/// Eight ellipsoids: |U (x − mean)| ≤ 1 on the surface at Mahalanobis distance τ, U upper
/// triangular (u00 u01 u02 u11 u12 u22). Lanes without an ellipsoid are NaN and never met.
struct alignas(32) EllipsoidBlock {
  float mean[3][kWidth];
  float u[6][kWidth];
  union {
    uint32_t accept_below[kWidth];  ///< Accepted iff hash < this, or always where 0xffffffff.
    float depth[kWidth];            ///< kPathLength: κ √(2π) / τ.
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
/// arithmetic, where U is the float nearest to the true factor; those of kCareful leaves may be
/// inflated.
Bvh build_bvh(const elements::Model& model);

}  // namespace underbrush::trace
