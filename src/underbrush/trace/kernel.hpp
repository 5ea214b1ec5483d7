/// \file
/// The inner loops, compiled once per instruction set and chosen at run time. They decide in float
/// what floats can decide beyond doubt, by bounds on their rounding, and leave the rest to
/// `settle_*`, in double: every instruction set gives the same answer, that of `intersect`.
#pragma once
#include <array>
#include <vector>

#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/order.hpp"
#include "underbrush/trace/scene_tree.hpp"

namespace underbrush::trace {

/// A model's arrays, bare: inline functions of the standard library must not be compiled into the
/// kernels.
struct ModelView {
  struct Mesh {
    const float* vertices;      // x y z
    const uint32_t* triangles;  // three corners
    const elements::HitCount* hit;
    double sigma_m, roughness_m;
  } ground, surface;
  const elements::Ellipsoid* ellipsoids;
  uint32_t ground_count, triangle_count;
  double tau2;
  bool voxels;
};

/// What the kernels need of a world.
struct View {
  const Node* nodes;
  const Subtree* entries;
  uint32_t root;
  double origin[3];  ///< Of the tree, world (m).
  const elements::Instance* instances;
  const elements::Model* const* models;
  const ModelView* model_views;
  const Bvh* bvhs;
};

/// The kinds of query.
enum class Query {
  kAccepted,  ///< The nearest element that accepts it.
  kSurface,   ///< The nearest triangle, whatever its hit probability.
  kAll,       ///< Every element met.
};

/// A ray of a batch and an element that it may meet.
struct Candidate {
  uint32_t ray, instance, element;
};

/// The rays of a query and what it has found.
struct Batch {
  const Ray* rays;
  const uint64_t* keys;          ///< kAccepted
  const double* entry_limits_m;  ///< kAll: boxes entered beyond this may be left out.
  RangeLimits limits;
  const FloatRays* float_rays;  ///< Of the rays from `first` on.
  size_t first;

  Intersection* best;  ///< Out, one a ray: kAccepted, kSurface; else null.
  /// Out: ends of rays that are certain but not yet in `best`; room for kBatchRays.
  Candidate* known;
  size_t known_count;
  std::vector<Candidate> candidates;  ///< Out: kAll; undecided, in no order; rays as in `rays`.
};

/// How an instance's frame is reached from the tree's.
struct Placement {
  const Bvh* bvh;
  double rotation[9];  ///< model from world, row by row
  double centre[3];    ///< The packet's centre in the model's frame.
  double scale;
  double tau2;    ///< The model's τ².
  uint64_t salt;  ///< Of the beams' keys.
  bool translation;
};

/// Places a point (relative to the tree's origin) in an instance.
Placement place(const View& view, uint32_t instance, const double centre[3]);
/// Decides in double whether ray `ray` of the batch ends at the element or at what it has. `have`:
/// the element and instance that the kernel holds for it, known to be met and accepted but not yet
/// in `best`, or kNone. True if the new one is nearer.
bool resolve_nearest(const View& view, Query query, Batch& batch, size_t ray, uint32_t instance,
                     uint32_t element, uint32_t have_instance, uint32_t have_element);
/// `intersect` of a candidate.
Intersection intersect_placed(const View& view, const Batch& batch, const Candidate& candidate);
/// The ray in the instance's model.
void place_ray(const View& view, const Batch& batch, const Candidate& candidate, double origin[3],
               double direction[3]);
/// A model and the transform of one of its instances.
struct InstanceTransform {
  const ModelView* model;
  double translation[4];  ///< The fourth is 0.
  double scale_tau2[2];   ///< Scale, and the square of the model's τ.
  bool is_translation;
};
/// The transform of an instance.
InstanceTransform transform_of(const View& view, uint32_t instance);
/// Notes that a ray may meet an element.
void add_candidate(Batch& batch, size_t ray, uint32_t instance, uint32_t element);

/// The kernels of one instruction set; the tree must not be empty.
struct Kernels {
  const char* name;
  /// Fills `float_rays` from up to kBatchRays rays; keys may be null.
  void (*convert_rays)(const View&, const Ray* rays, const uint64_t* keys, size_t count,
                       FloatRays& float_rays);
  /// Traces the rays numbered from the batch's first in `order`, runs of kPacketRays where they
  /// point alike; as many numbers more must follow, copies of the last.
  void (*trace)(const View&, Query, Batch&, const uint32_t* order, size_t count);
  /// out[i] = `intersect` of candidate i with the batch's limits, or the best of its ray if `out`
  /// is null.
  void (*intersect_many)(const View&, const Batch&, const Candidate*, size_t count,
                         Intersection* out);
};

extern const Kernels kKernelsBase, kKernelsAvx2, kKernelsAvx512;

}  // namespace underbrush::trace
