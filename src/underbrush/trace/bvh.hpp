/// \file
/// This file has the bounding volume hierarchy over the elements of one model. It is laid out for
/// vector instructions: a leaf is a block of up to eight elements of one kind, or eight pairs of
/// triangles.
#pragma once
#include <cstdint>

#include "underbrush/elements/model.hpp"
#include "underbrush/trace/hierarchy.hpp"

namespace underbrush::trace {

/// The kinds of leaf of a model's tree, in bits 29 and 30 of a leaf's reference. Leaves of the tree
/// over instances have no kind, because they hold subtrees of models.
enum class LeafKind : uint32_t {
  kEllipsoids = 0,
  /// Ellipsoids that are always decided in double precision, because they are bounded by voxels or
  /// too thin for floats.
  kCareful = 0x20000000u,
  kTriangles = 0x40000000u,
  kPathLength = 0x60000000u,  ///< Ellipsoids with a path-length opacity.
};

/// The kind of the leaf behind a reference.
__attribute__((always_inline)) constexpr LeafKind leaf_kind(uint32_t reference) {
  return LeafKind(reference & kKindMask);
}
/// The reference of a leaf.
constexpr uint32_t leaf_reference(LeafKind kind, uint32_t index) {
  return kLeaf | uint32_t(kind) | index;
}

/// The number of an element is in the low bits of `EllipsoidBlock::element`; the bits from this one
/// on have the place of its class in the grain of the model (`elements::Grain::place_of`).
inline constexpr int kGrainShift = 29;
inline constexpr uint32_t kElementMask = (1u << kGrainShift) - 1;
static_assert(elements::Grain::kMostClasses < 1u << (32 - kGrainShift));

/// The threshold of the trials at an element that stops every beam; those of others are less.
inline constexpr uint32_t kAlways = 0xffffffffu;

/// Eight ellipsoids in columns. The surface at Mahalanobis distance τ is |U (x − mean)| = 1 with U
/// upper triangular (u00 u01 u02 u11 u12 u22). Lanes without an ellipsoid are NaN, so that no ray
/// meets them.
struct alignas(32) EllipsoidBlock {
  float mean[3][kWidth];
  float u[6][kWidth];
  union {
    uint32_t accept_below[kWidth];  ///< A hit iff hash < this, or if it is kAlways.
    float depth[kWidth];            ///< For kPathLength: κ √(2π) / τ.
  };
  uint32_t element[kWidth];  ///< Element numbers, with the place in the grain above `kGrainShift`.
};

/// Eight pairs of triangles in columns. The triangles of a pair share an edge: the first one has
/// the corners 0 1 2, and the second one 0 2 3. Where there is only one, corners 2 and 3 are the
/// same. Lanes without a triangle are NaN.
struct alignas(64) TriangleBlock {
  float corner[4][3][kWidth];  ///< corner[vertex][axis][lane]
  uint32_t accept_below[2][kWidth];
  /// The numbers of both triangles, or Intersection::kNone. The bits from `kTurnShift` on have the
  /// place in `kTurns` of the order in which the mesh has the corners.
  uint32_t element[2][kWidth];
};

inline constexpr int kTurnShift = 29;
/// The corners of the first and of the second triangle of a pair in the order of the mesh.
inline constexpr uint8_t kTurns[2][3][3] = {{{1, 2, 0}, {0, 1, 2}, {2, 0, 1}},
                                            {{3, 0, 2}, {2, 3, 0}, {0, 2, 3}}};

/// The hierarchy over all elements of a model. Coordinates are relative to the model's origin, m.
struct Bvh {
  HugeVector<Node> nodes;
  HugeVector<EllipsoidBlock> ellipsoids;
  HugeVector<TriangleBlock> triangles;
  uint32_t root = kEmpty;
  Box box;

  size_t bytes() const;
};

/// Builds the hierarchy of a model; element numbers are those of the model, or of the whole of
/// which it is a part. Bounds are
/// conservative: a ray is tested against an ellipsoid wherever it enters |U (x − mean)| ≤ 1 in
/// exact arithmetic, with U the float nearest to the true factor. The ellipsoids of
/// `LeafKind::kCareful` leaves may be inflated.
Bvh build_bvh(const elements::Model& model);

}  // namespace underbrush::trace
