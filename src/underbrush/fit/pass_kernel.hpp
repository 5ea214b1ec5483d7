/// \file
/// This file declares the inner loops of a pass over the meetings of beams and elements, once for
/// each instruction set. They compute in single precision with IEEE operations alone, so every
/// instruction set gives the same bits.
#pragma once
#include <cstddef>
#include <cstdint>

namespace underbrush::fit {

/// A beam in the frame of a model, i.e. relative to its origin.
struct ListedBeam {
  float origin[3];     ///< m.
  float range_m;       ///< m; kMiss without a return.
  float direction[3];  ///< Unit vector.
  float reach_m;       ///< Elements whose closest approach lies beyond this are not met, m.
};

/// What does not change of a meeting with a triangle as the model is refined.
struct TriangleMeeting {
  float t_m;   ///< Range, m.
  float tilt;  ///< 1 / max(cos²θ, 10⁻⁴), with the angle of incidence θ.
};

/// A meeting as an element sees it.
struct ElementMeeting {
  uint32_t beam;  ///< Number of the beam in its block.
  uint32_t slot;  ///< Number of the meeting in its block.
};

/// An ellipsoid as a pass needs it. The inverse L⁻¹ of its Cholesky factor is lower triangular.
struct EllipsoidForm {
  float mean[3];        ///< μ, m.
  float whiten[6];      ///< L⁻¹ (1/m): xx, yx yy, zx zy zz.
  float opacity_per_m;  ///< κ √(2π), 1/m; 0 for an ellipsoid without a density.
  float p;              ///< Probability of a return from an ellipsoid without a density.
};

/// A model as a pass needs it.
struct ModelForm {
  const EllipsoidForm* ellipsoids;
  const float* triangle_p;
  uint32_t ground_triangles, triangles;  ///< Triangles of the ground, and of both meshes.
  float range_variance[2];               ///< σ_r² of the ground and the surface, m².
  float roughness_variance[2];           ///< h² of the ground and the surface, m².
  float tau2;                            ///< τ².
  float min_range_m;                     ///< Elements nearer than this are not met, m.
};

/// What a pass computes for each meeting of a run of beams. Each points to as many places as there
/// are meetings.
struct MeetingColumns {
  float* t_m;      ///< Range of the closest approach, m.
  float* sigma_m;  ///< σ, m.
  float* p;        ///< Probability of a return; negative where the beam does not meet the element.
  float* density;  ///< N(z; t, σ²), 1/m; 0 for misses and beyond `kFarthestMisfit` σ.
};

/// Gaussians count as zero beyond so many σ, and ellipsoids so far beyond a return are not met.
inline constexpr float kFarthestMisfit = 8;

/// Fields of the sums of one ellipsoid, each a sum in fixed point of resolution 2⁻²⁶.
enum SumField : size_t {
  kHits,
  kPasses,
  kLoss,
  kDensitySlope,
  kDensityCurvature,
  kShiftSlope,
  kShiftCurvature = kShiftSlope + 3,
  kStretchSlope = kShiftCurvature + 6,
  kStretchCurvature = kStretchSlope + 6,
  kAlong = kStretchCurvature + 6,
  kSumFields = kAlong + 6
};

/// The shares of the meetings of a block, by slot, and −log f of its beams, nats.
struct ShareColumns {
  const float* hit;
  const float* pass;
  const float* loss;
};

/// The inner loops for one instruction set.
struct PassKernels {
  /// Computes the columns of the meetings of the beams `beam` to `beam_end`. Beam b meets the
  /// elements `met[first[b]]` to `met[first[b + 1]]`, those of them that are triangles in the order
  /// of `on_triangle`, which begins with the first of them. Places count from `first[beam]`.
  void (*approach)(const ModelForm& model, const ListedBeam* beams, const uint32_t* first,
                   size_t beam, size_t beam_end, const uint32_t* met,
                   const TriangleMeeting* on_triangle, const MeetingColumns& out);
  /// Adds the terms of `EllipsoidSums` of the listed meetings with an ellipsoid to its `sums`.
  void (*add)(const EllipsoidForm& ellipsoid, const ListedBeam* beams, const ElementMeeting* list,
              size_t count, const ShareColumns& shares, int64_t* sums);
};

extern const PassKernels kPassBase;
#if defined(__x86_64__)
extern const PassKernels kPassAvx2, kPassAvx512;
#endif

/// The inner loops for the best instruction set that the machine has.
const PassKernels& pass_kernels();

}  // namespace underbrush::fit
