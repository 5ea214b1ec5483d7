/// \file
/// This file has the maximisation step, which makes the beams of a model more likely.
#pragma once
#include <span>

#include "underbrush/credit/beta_prior.hpp"
#include "underbrush/likelihood/element_sums.hpp"
#include "underbrush/likelihood/neighbourhood.hpp"

namespace underbrush::likelihood {

/// The options of `maximised`: the floor and the priors.
struct MaximisationOptions {
  double floor_m = 0.01;    ///< Least σ of an ellipsoid along any axis, m.
  double prior_points = 2;  ///< Weight of the shape of the neighbourhood in Σ, in points.
  double prior_hits = 0.5;  ///< Weight of the density of the neighbourhood in κ, in hits.
  /// Number k of parameters that an ellipsoid's own n points were fitted with. Such points spread
  /// less about the fit than new points will, so squared misfits are raised by (n + k) / (n − k),
  /// at most fourfold.
  double spent_points = 2;
  /// The number k for the ellipsoids of the start; 0 leaves them as they are. It may be smaller,
  /// because the covariances of these ellipsoids have a prior.
  double spent_at_start = 2;
  credit::HitPrior triangle{10, 0};  ///< Prior hits and misses of a triangle.
  double roughness_hits = 2;  ///< Weight of the mesh's roughness in that of a triangle, in hits.
};

/// Gives each ellipsoid without a density a density κ (1/m), such that a beam through it at a usual
/// distance has the hit probability that the ellipsoid had. Its Σ was fitted to its n hits with k =
/// `options.spent_at_start` parameters and is smaller than the spread of new points, so it becomes
/// Σ (n + k) / (n − k), at most fourfold. Ellipsoids with a density stay as they are. A mesh has
/// the range noise `range_noise_m` (m) at most; the excess becomes roughness. The roughness of a
/// mesh without one becomes its range noise, at least `range_noise_m`, and its range noise becomes
/// `range_noise_m`. A mesh whose triangles have roughnesses of their own stays as it is. Returns
/// the changed model.
elements::Model with_densities(const elements::Model& model, double range_noise_m,
                               const MaximisationOptions& options);

/// Makes the outcomes at the ellipsoids more certain, by an exponent γ = `sharpness` > 0, and
/// returns the changed model. A beam with the optical depth a through an ellipsoid then has the
/// depth ln 2 (a / ln 2)^γ, so that p = ½ stays and other p move towards 0 or 1, and σ becomes σ /
/// √γ.
///
/// To this end Σ becomes Σ / γ, τ becomes τ √γ, and the density follows for the ellipsoid's mean σ,
/// which is exact for a sphere. The same beams meet the same ellipsoids at the same ranges.
/// Ellipsoids without a density keep their p.
elements::Model sharpened(const elements::Model& model, double sharpness);

/// Corrects the densities of ellipsoids by beams that they were not fitted to, and returns the
/// changed model. The places and shapes of ellipsoids of few points follow the beams of the fit,
/// and so their densities are too great for other beams, the more so the more beams pass.
/// Ellipsoids of alike shares of hits therefore get one factor of κ, by a step of Fisher scoring in
/// ln κ:
///
///     ln f = Σ ∂ℓ/∂ln κ / (Σ I + ν),   ν = 100 hits.
elements::Model calibrated(const elements::Model& model, const ElementSums& held_out);

/// Takes one step of Fisher scoring for each element separately and returns the changed model. The
/// step changes ln κ, μ and Σ of the ellipsoids, p and roughness of the triangles, and the range
/// noise of the meshes. `neighbours` are those of the model's ellipsoids, and `stride` in (0, 1]
/// scales all moves. `open` is as in `RefinementLimits`. Hits and misses of an element become its
/// soft counts.
elements::Model maximised(const elements::Model& model, const ElementSums& sums,
                          const Neighbours& neighbours, const MaximisationOptions& options,
                          double stride, std::span<const Eigen::Matrix3f> open = {});

}  // namespace underbrush::likelihood
