/// \file
/// The inner loops, compiled once per instruction set and chosen at run time. They decide in float
/// what floats can decide beyond doubt, by bounds on their rounding, and leave the rest to
/// `settle_*`, in double: every instruction set gives the same answer, that of `meet`.
#pragma once
#include <array>
#include <vector>

#include "underbrush/trace/scene_tree.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::trace {

/// What the kernels need of a world.
struct View {
  const Node* nodes;
  const Entry* entries;
  uint32_t root;
  double origin[3];  ///< Of the tree, world (m).
  const elements::Instance* instances;
  const elements::Model* const* models;
  const Bvh* bvhs;
};

/// What a beam looks for.
enum class Ask {
  kAccepted,  ///< The nearest element that accepts it.
  kSurface,   ///< The nearest triangle, whatever its hit probability.
  kAll,       ///< Every element met.
};

/// Rays that are traced together.
inline constexpr int kPacket = 64;

/// A candidate that float arithmetic could not rule out.
struct Candidate {
  uint32_t ray;  ///< Within the packet.
  uint32_t instance, element;
};

/// A query of `kPacket` rays, in double; what the kernels settle with. Where there are fewer, the
/// last stands in the other places too.
struct Batch {
  const Ray* ray[kPacket];
  uint64_t key[kPacket];
  double entry_limit_m[kPacket];  ///< kAll: boxes entered beyond this may be left out.
  RangeLimits limits;

  Met best[kPacket];                   ///< Out: kAccepted, kSurface.
  std::vector<Candidate> candidates;   ///< Out: kAll; undecided, in no order.
};

/// How an instance's frame is reached from the tree's.
struct Placement {
  const Bvh* bvh;
  double rotation[9];  ///< model from world, row by row
  double centre[3];    ///< The packet's centre in the model's frame.
  double scale;
  uint64_t salt;  ///< Of the beams' keys.
  bool translation;
};

/// Places a point (relative to the tree's origin) in an instance.
Placement place(const View& view, uint32_t instance, const double centre[3]);
/// Decides in double whether ray `ray` of the batch ends at the element or at what it has. `have`:
/// the element and instance that the kernel holds for it, known to be met and accepted but not yet
/// in `best`, or kNone. True if the new one is nearer.
bool settle_nearest(const View& view, Ask ask, Batch& batch, int ray, uint32_t instance,
                    uint32_t element, uint32_t have_instance, uint32_t have_element);
/// Puts into `best` what the kernel knows that the ray ends at.
void settle_known(const View& view, Batch& batch, int ray, uint32_t instance, uint32_t element);
void add_candidate(Batch& batch, int ray, uint32_t instance, uint32_t element);

/// The kernels of one instruction set; the tree must not be empty.
struct Kernels {
  const char* name;
  /// Traces the whole batch; false, with nothing done, if its rays point too far apart.
  bool (*packet)(const View&, Ask, Batch&);
  /// Traces ray `ray` of the batch alone.
  void (*one)(const View&, Ask, Batch&, int ray);
};

extern const Kernels kKernelsBase, kKernelsAvx2, kKernelsAvx512;

}  // namespace underbrush::trace
