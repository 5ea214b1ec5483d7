/// \file
/// The M-step: the model that follows from what the beams say of each element.
#pragma once
#include "underbrush/fit/beta_prior.hpp"
#include "underbrush/fit/element_sums.hpp"

namespace underbrush::fit {

/// Options of `maximised`: what is held to be likely before any beam is seen.
struct MaximisationOptions {
  double floor_m = 0.02;    ///< Least σ of an ellipsoid along any axis.
  double prior_points = 4;  ///< Points' worth of a sphere of the ellipsoid's size in its Σ.
  /// Hits' worth of evidence that matter is opaque to beams that pass at Mahalanobis distance
  /// `opaque_distance`.
  double opaque_hits = 4, opaque_distance = 2;
  /// Parameters that an ellipsoid's own points were spent on: n points spread about what was fitted
  /// to them less than new ones by (n − k) / (n + k), at most to a quarter.
  double spent_points = 3;
  HitPrior triangle{20, 0};  ///< Hits and misses of a triangle before any beam.
};

/// The model with each ellipsoid given a density κ such that a beam through it at a usual distance
/// finds the hit probability that it had; where it has one, it stays. A mesh without roughness is
/// given its range noise as roughness.
elements::Model with_densities(const elements::Model& model, double range_noise_m);

/// The model with its ellipsoids' answers more decided, `sharpness` γ > 0 times: a beam that found
/// the optical depth a finds ln 2 (a / ln 2)^γ, so that what stopped half of the beams still does,
/// what stopped most stops nearly all and the rest is passed; σ falls by √γ. As Σ / γ, a density
/// that follows from it (for the ellipsoid's mean σ; exact for a sphere) and τ √γ: the same beams
/// meet the same ellipsoids at the same ranges. Ellipsoids without a density keep their p.
elements::Model sharpened(const elements::Model& model, double sharpness);

/// One step of Fisher scoring for all elements at once, each by itself: κ (in its logarithm), μ and
/// Σ of the ellipsoids, p of the triangles, range noise and roughness of the meshes. `stride` in
/// (0, 1] shortens all moves. Hits and misses of an element become its soft counts.
elements::Model maximised(const elements::Model& model, const ElementSums& sums,
                          const MaximisationOptions& options, double stride);

}  // namespace underbrush::fit
