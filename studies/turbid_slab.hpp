/// \file
/// A slab of leaves whose density is known, above flat ground: the measurements of beams in it, and
/// their expected values.
#pragma once
#include <optional>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// The inclinations of the leaves of a slab.
enum class LeafAngles {
  kSpherical,   ///< In all directions alike.
  kHorizontal,  ///< All leaves lie flat.
  kVertical     ///< All leaves stand upright, in all bearings alike.
};

/// Returns G, the mean area that a unit of leaf area covers across a beam of this direction (unit
/// vector, world): 1/2 for spherical, |cos θ| for horizontal and (2/π) sin θ for vertical leaves, θ
/// being the angle between the beam and the vertical.
double projection(LeafAngles angles, const Vec3& direction);

/// The part of a ray inside the slab, m along the ray.
struct SlabCrossing {
  double enter_m = 0, leave_m = 0;
};

/// A turbid slab over opaque ground at z = 0 m: leaves at random places (a Poisson process), so
/// that the free path of a beam is exponential with the extinction k = area density · G.
///
/// A beam that widens needs leaves of some size, because it touches leaves beside its axis. They
/// are discs of radius r = 5 cm in all directions alike, and every leaf that the beam touches gives
/// an echo. A beam whose radius is R touches discs whose projection, widened by R, covers the axis.
/// The mean area of that is π r² / 2 + (π² r / 2) R + π R² (Steiner's formula), so that
///
///     k = area density · (1/2 + (π/2) R/r + (R/r)²)   with R = divergence / 2 · range.
///
/// Each beam meets leaves of its own.
struct TurbidSlab {
  double area_density = 0.5;  ///< m²/m³; one-sided.
  LeafAngles angles = LeafAngles::kSpherical;
  double divergence_rad = 0;  ///< Full angle of the beams; not 0 only for spherical leaves.

  static constexpr double kHalfWidthM = 20, kLowM = 4, kHighM = 14;  ///< m; x and y are about 0.
  static constexpr double kLeafRadiusM = 0.05;
  static constexpr double kNoiseM = 0.01;  ///< σ of the measured range, m.

  /// Returns the part of a ray inside the slab, if there is one.
  static std::optional<SlabCrossing> crossing(const Ray& ray);
  /// Returns the integral of the extinction over a part of a ray; the beam passes it with the
  /// probability e^−depth.
  double optical_depth(const Ray& ray, double from_m, double to_m) const;
};

/// Answers beams: their first leaf, else the ground, else a miss (beyond `max_range_m` of the log).
/// Throws `std::invalid_argument` for beams that widen among leaves that are not spherical.
BeamLog measured(const TurbidSlab& slab, BeamLog beams, uint64_t seed);

/// The area density that `rasters::canopy_of` must give for voxels of 1 m inside the slab, because
/// it takes G = 1/2 and the mean of the gaps along three axes. It is the true one for spherical
/// leaves only.
double area_density_of_voxels(const TurbidSlab& slab);

/// Returns the beams of five tripods, 1.5 m above the ground, within 7 m of the middle, as misses,
/// in steps of `step_rad` from −50° of elevation to the zenith, one scan per tripod and one ring
/// per elevation.
BeamLog tripod_beams(double step_rad);

/// The origins and directions of the beams whose transmission is computed.
enum class SlabView {
  kTripods,   ///< The tripods, in random directions from 10° of elevation on.
  kOverhead,  ///< Straight down from 30 m, within 8 m of the middle along x and y.
  kMobile  ///< 2 m high at x = −6, 0 and 6 m, in a fan that is tilted by 30° from upright along x
           ///< and reaches 45° to both sides.
};
inline constexpr const char* kSlabViews[] = {"tripods", "overhead", "mobile"};

/// Returns random beams of a view as misses; all cross the slab.
BeamLog view_beams(SlabView view, size_t beams, uint64_t seed);

/// A share of beams, and its standard error in a sample of as many independent beams.
struct Transmission {
  double share = 0, error = 0;
};
/// Returns the share of the beams that the slab must let through.
Transmission true_transmission(const TurbidSlab& slab, const BeamLog& beams);
/// Returns the share of the beams of an answered log that end on the ground (below half the height
/// of the slab's lower side) or nowhere.
double transmission_of(const BeamLog& answered);

}  // namespace underbrush::studies
