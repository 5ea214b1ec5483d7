/// \file
/// The inner loops, compiled once per instruction set and chosen at run time. They find candidates
/// in float with a margin; `settle()` decides each candidate in double, so that every instruction
/// set gives the same answer.
#pragma once
#include <vector>

#include "underbrush/trace/bvh.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// One ray in the model's frame, and what is asked of it.
struct Query {
  Vec3 origin, direction;
  RangeLimits limits;
  uint64_t key = 0;  ///< Of the beam's random numbers.
};

/// What the kernels need of a world.
struct View {
  const elements::Model* model;
  const Node* nodes;
  const EllipsoidBlock* ellipsoids;
  const TriangleBlock* triangles;
  uint32_t root;
};

/// Decides a candidate in double and keeps it if it comes before `best`; true if it did.
bool settle_nearest(const View& view, const Query& query, uint32_t element, Met& best);
/// Decides a candidate in double and appends it to `met` if the ray meets it.
void settle_all(const View& view, const Query& query, uint32_t element, std::vector<Met>& met);

/// The kernels of one instruction set.
struct Kernels {
  const char* name;
  /// Nearest accepted element of either kind.
  void (*nearest_accepted)(const View&, const Query&, Met& best);
  /// Nearest triangle, whatever its hit probability.
  void (*nearest_triangle)(const View&, const Query&, Met& best);
  /// All elements met whose bounds the ray enters before `entry_limit_m`, in no order.
  void (*all_met)(const View&, const Query&, double entry_limit_m, std::vector<Met>& met);
};

extern const Kernels kKernelsBase, kKernelsAvx2, kKernelsAvx512;

}  // namespace underbrush::trace
