/// \file
/// This file is the interface to the inner loops, which are compiled once for each instruction set
/// and chosen at run time.
///
/// Rays are traced in packets of kPacketRays rays that point alike. A packet descends the tree as a
/// whole. At each node, one vector test compares eight boxes with the frustum that encloses the
/// packet's rays; only boxes that pass are tested against single rays. Blocks of eight ellipsoids
/// or triangles are tested in the same way.
///
/// The loops compute in floats with bounds on their rounding. Cases that these bounds leave
/// undecided go to `resolve_nearest`, in double precision, so that every instruction set gives the
/// answer of `intersect`.
#pragma once
#include <array>
#include <vector>

#include "underbrush/trace/candidate.hpp"
#include "underbrush/trace/element_math.hpp"
#include "underbrush/trace/order.hpp"
#include "underbrush/trace/scene_tree.hpp"

namespace underbrush::trace {

/// The cells of a grain, 1/m; 0 where trials are drawn anew. A grain has as many kinds of cells of
/// ellipsoids as the bits of an element number distinguish (`kGrainShift`).
struct CellsPerM {
  double triangles;
  double ellipsoids[elements::Grain::kMostClasses + 1];  // by `elements::Grain::place_of`
  int kinds;                                             // the number of them in use
};

/// The arrays of a model as bare pointers. The kernels must not use inline functions of the
/// standard library, because the linker could keep the copy that was compiled for a larger
/// instruction set.
struct ModelView {
  struct Mesh {
    const float* vertices;      // x y z
    const uint32_t* triangles;  // three corners
    const elements::HitCount* hit;
    double sigma_m, roughness_m;
    const float* roughness;  // of each triangle, m; null where all have roughness_m
  } ground, surface;
  const elements::Ellipsoid* ellipsoids;
  uint32_t ground_count, triangle_count;  // the numbers of the first elements that are not those
  double tau2;
  bool voxels;
  CellsPerM cells_per_m;
  bool sways;  // whether the matter of ellipsoids moves with the time (`kSwaying`)
  double leaf_level, leaf_slope;  // of `LeafAngleDistribution`
  struct Numbers {
    const uint32_t* first;
    uint32_t count;
  } numbers[3];  // `elements::PartOf::numbers`; none where the model is whole
};

/// The parts of a world that the kernels use.
struct View {
  const Node* nodes;
  const Subtree* entries;
  uint32_t root;
  double origin[3];  ///< Origin of the tree in the world, m.
  const elements::Instance* instances;
  const uint32_t* numbers;  ///< `elements::Scene::numbers`; null where the scene is whole.
  const elements::Model* const* models;
  const ModelView* model_views;
  const Bvh* bvhs;
};

/// The factors of `accept_bits`, and `kCellFactor`, the same in all lanes. They are kept in memory,
/// because the compiler would make constants anew from integers for each trial.
struct HashFactors {
  alignas(64) uint32_t trial[3][16], cell[3][16];
};
extern const HashFactors kHashFactors;

/// The kind of a query.
enum class Query {
  kAccepted,  ///< The nearest element that stops the beam.
  kSurface,   ///< The nearest triangle, whatever its hit probability.
  kAll,       ///< Every element met.
};

/// Marks the place of a triangle in the blocks of a tree, kInBlock | (block·kWidth + lane)·2 +
/// which of the pair, in contrast to the number of an element.
inline constexpr uint32_t kInBlock = 0x80000000u;
/// The largest number of blocks of triangles with distinct places.
inline constexpr size_t kMostTriangleBlocks = kInBlock / (2 * kWidth) - 1;

/// Copies of the last pair for which `Known` has room.
inline constexpr size_t kKnownBeyond = 3;
/// Pairs of a ray and the element where it ends.
struct Known {
  size_t count;
  Candidate of[kBatchRays + kKnownBeyond];
};

/// A query: its rays, and the results for them so far.
struct Batch {
  const Ray* rays;
  const uint64_t* keys;          ///< A key for each ray, for kAccepted.
  const double* entry_limits_m;  ///< For kAll: boxes entered beyond this range may be left out.
  RangeLimits limits;
  const FloatRays* float_rays;  ///< The rays from `first` on, in single precision.
  size_t first;

  Intersection* best;  ///< Output for kAccepted and kSurface: one for each ray; else null.
  /// Output: pairs of a ray and the element where it ends, certain but not yet in `best`. Triangles
  /// are given by their places.
  Known *ellipsoids, *triangles;
  std::vector<Candidate> candidates;  ///< Output for kAll: undecided pairs, in no order.
  std::vector<ApproachBound> bounds;  ///< Output for kAll: one per candidate.
};

/// The transformation from the tree's frame to that of an instance.
struct Placement {
  const Bvh* bvh;      ///< The hierarchy of the instance's model.
  double rotation[9];  ///< From world to model, row by row.
  double centre[3];    ///< Centre of the packet in the model's frame, m.
  double scale;
  double tau2;                    ///< Square of the model's τ.
  uint64_t salt;                  ///< Combined with the keys of the beams.
  const CellsPerM* cells_per_m;   ///< As in `ModelView`.
  bool sways;                     ///< As in `ModelView`.
  double leaf_level, leaf_slope;  ///< As in `ModelView`.
  bool translation;               ///< Whether the transformation is a translation alone.
};

/// Computes the transformation to an instance, and transforms `centre` (relative to the tree's
/// origin, m).
Placement place(const View& view, uint32_t instance, const double centre[3]);
/// Decides in double precision whether ray `ray` of the batch ends at an element or at the one that
/// it had before. `have_element` (the place of a triangle) and `have_instance` are those of the
/// element that the kernel holds for the ray, certain but not yet in `best`, or kNone. Returns true
/// if the new element is nearer; it is then in `best`.
bool resolve_nearest(const View& view, Query query, Batch& batch, size_t ray, uint32_t instance,
                     uint32_t element, uint32_t have_instance, uint32_t have_element);
/// Computes `intersect` for a candidate.
Intersection intersect_placed(const View& view, const Batch& batch, const Candidate& candidate);
/// Transforms the ray of a candidate into the frame of the instance's model.
void place_ray(const View& view, const Batch& batch, const Candidate& candidate, double origin[3],
               double direction[3]);
/// A model and the transform of one of its instances.
struct InstanceTransform {
  const ModelView* model;
  const TriangleBlock* triangles;  ///< The blocks of the model's tree.
  double translation[4];           ///< m; the fourth is 0.
  double scale_tau2[2];            ///< Scale, and square of the model's τ.
  bool is_translation;
};
/// Finds the model of an instance and its place in the world.
InstanceTransform transform_of(const View& view, uint32_t instance);
/// Adds a candidate to the batch.
void add_candidate(Batch& batch, const Candidate& candidate, const ApproachBound& bound);

/// The kernels of one instruction set. Their tree must not be empty.
struct Kernels {
  const char* name;
  /// Converts up to kBatchRays rays to single precision; `keys` may be null.
  void (*convert_rays)(const View&, const Ray* rays, const uint64_t* keys, size_t count,
                       FloatRays& float_rays);
  /// Traces the rays with the numbers `order`, counted from the batch's first ray, in packets of
  /// kPacketRays where they point alike. After `count` numbers, kPacketRays copies of the last one
  /// must follow.
  void (*trace)(const View&, Query, Batch&, const uint32_t* order, size_t count);
  /// Computes `intersect` of each candidate with the batch's limits into out[i].
  void (*intersect_many)(const View&, const Batch&, const Candidate*, size_t count,
                         Intersection* out);
  /// Computes `intersect` of the batch's known pairs into the best of their rays.
  void (*answer_known)(const View&, const Batch&);
};

extern const Kernels kKernelsBase, kKernelsAvx2, kKernelsAvx512;

}  // namespace underbrush::trace
