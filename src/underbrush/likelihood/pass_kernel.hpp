/// \file
/// This file declares the inner loops of a pass over the meetings of beams and elements, once for
/// each instruction set. They compute in single precision with IEEE operations alone, so every
/// instruction set gives the same bits.
#pragma once
#include <cstddef>
#include <cstdint>

namespace underbrush::likelihood {

/// A beam in the frame of a model, i.e. relative to its origin.
struct ListedBeam {
  float origin[3];     ///< m.
  float range_m;       ///< m; kMiss without a return.
  float direction[3];  ///< Unit vector.
  float reach_m;       ///< Elements whose closest approach lies beyond this are not met, m.
};

/// The part of a meeting with a triangle that stays the same as the model is refined.
struct TriangleMeeting {
  float t_m;   ///< Range, m.
  float tilt;  ///< 1 / max(cos²θ, 10⁻⁴), with the angle of incidence θ.
};

/// An ellipsoid in the form for a pass. The inverse L⁻¹ of its Cholesky factor is lower triangular.
struct EllipsoidForm {
  float mean[3];        ///< μ, m.
  float whiten[6];      ///< L⁻¹ (1/m): xx, yx yy, zx zy zz.
  float opacity_per_m;  ///< κ √(2π), 1/m; 0 for an ellipsoid without a density.
  float p;              ///< Probability of a return from an ellipsoid without a density.
};

/// A model in the form for a pass.
struct ModelForm {
  const EllipsoidForm* ellipsoids;
  const float* triangle_p;
  const float* roughness_variance;       ///< h² of each triangle, m².
  uint32_t ground_triangles, triangles;  ///< Triangles of the ground, and of both meshes.
  float range_variance[2];               ///< σ_r² of the ground and the surface, m².
  float tau2;                            ///< τ².
  float leaf_level, leaf_slope;          ///< As in `LeafAngleDistribution`.
  float min_range_m;                     ///< Elements nearer than this are not met, m.
};

/// The values that a pass computes for each meeting of a run of beams. Each column points to as
/// many places as there are meetings, and to eight more.
struct MeetingColumns {
  float* t_m;      ///< Range of the closest approach, m.
  float* sigma_m;  ///< σ, m.
  float* p;        ///< Probability of a return; negative where the beam does not meet the element.
  float* density;  ///< N(z; t, σ²), 1/m; 0 for misses and beyond `kFarthestMisfit` σ.
};

/// The meetings of a run of beams with ellipsoids, in the order of their places. The whitened
/// direction n of the beam has the length 1, and c is the whitened point of closest approach.
struct EllipsoidColumns {
  float* t_m;      ///< Range of the closest approach, m.
  float* sigma_m;  ///< σ, m.
  float* depth;    ///< Optical depth a.
  float* n[3];
  float* c[3];
  float* range_m;   ///< The range of the beam, m; kMiss without a return.
  uint32_t* place;  ///< The place of the meeting in the run.
  uint32_t* beam;   ///< The number of the beam in the block.
};

/// Gaussians count as zero beyond so many σ, and ellipsoids so far beyond a return are not met.
inline constexpr float kFarthestMisfit = 8;

/// Fields of the sums of one ellipsoid, each a sum in fixed point of resolution 2⁻²⁶.
enum SumField : size_t {
  kHits,
  kPasses,
  kDensitySlope,
  kDensityCurvature,
  kShiftSlope,
  kShiftCurvature = kShiftSlope + 3,
  kStretchSlope = kShiftCurvature + 6,
  kStretchCurvature = kStretchSlope + 6,
  kAlong = kStretchCurvature + 6,
  kSumFields = kAlong + 6
};

/// The length of the row of sums of an ellipsoid: `kSumFields`, filled up to whole cache lines.
inline constexpr size_t kSumRow = 32;

/// The sums of all ellipsoids, row by row, to which several threads may add. A lock guards all rows
/// whose numbers leave the same remainder; the number of locks is a power of two.
struct SumTable {
  int64_t* sums;
  uint8_t* locks;
  uint32_t lock_mask;
};

/// The shares of the meetings of a run, by place.
struct ShareColumns {
  const float* hit;
  const float* pass;
};

/// The inner loops for one instruction set.
struct PassKernels {
  /// Computes the columns of the meetings of the beams `beam` to `beam_end`. Beam b meets the
  /// elements `met[first[b]]` to `met[first[b + 1]]`, those of them that are triangles in the order
  /// of `on_triangle`, which begins with the first of them. Places count from `first[beam]`.
  /// Returns the number of meetings with ellipsoids.
  size_t (*approach)(const ModelForm& model, const ListedBeam* beams, const uint32_t* first,
                     size_t beam, size_t beam_end, const uint32_t* met,
                     const TriangleMeeting* on_triangle, const MeetingColumns& out,
                     const EllipsoidColumns& ellipsoids);
  /// Adds the terms of `EllipsoidSums` of `count` meetings to the rows of their ellipsoids.
  /// `ellipsoid[place]` is the number of an ellipsoid, counted from `first_ellipsoid`.
  void (*add)(const EllipsoidColumns& meetings, size_t count, const uint32_t* ellipsoid,
              uint32_t first_ellipsoid, const ShareColumns& shares, const SumTable& sums);
};

extern const PassKernels kPassBase;
#if defined(__x86_64__)
extern const PassKernels kPassAvx2, kPassAvx512;
#endif

/// The inner loops for the best instruction set that the machine has.
const PassKernels& pass_kernels();

}  // namespace underbrush::likelihood
