/// \file
/// Ground segmentation: two methods that take the points of a tile and return one flag for each.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {
/// Ground segmentation and the ground surface.
namespace ground {

/// Options of `spherical_variance`. The defaults are those of [tallavajhula18]'s authors.
struct SphericalVarianceOptions {
  int neighbours = 10;     ///< Most neighbours of a point, itself included; the nearest are taken.
  double radius_m = 5;     ///< m; largest distance of a neighbour: the ball d_φ.
  int min_neighbours = 4;  ///< N_min: with fewer neighbours φ is `default_variance`.
  double default_variance = 0.01;
  int smooth_neighbours = 100;  ///< φ is averaged over this many neighbours; 0 = not smoothed.
  double smooth_radius_m = 10;  ///< m; largest distance of a neighbour in that average.
  double smooth_scale_m = 10;  ///< m; a neighbour at distance d has the weight exp(−d²/scale²).
  double threshold = 0.09;     ///< A point is ground iff its φ is below this.
};

/// Returns φ = λ1 / (λ1 + λ2 + λ3) of each point, where λ1 ≤ λ2 ≤ λ3 are the eigenvalues of the
/// covariance of its neighbours ([tallavajhula18] §IV): 0 for a plane, 1/3 for a ball. It is
/// smoothed as the options ask, and NaN for a point that is not finite.
std::vector<float> spherical_variances(std::span<const Vec3f> points,
                                       const SphericalVarianceOptions& options = {});

/// Flags as ground (1) the points with φ < threshold ([tallavajhula18] §IV), others as 0. Flat
/// walls count as ground: the paper's method is meant for natural terrain.
std::vector<uint8_t> spherical_variance(std::span<const Vec3f> points,
                                        const SphericalVarianceOptions& options = {});

/// Options of `lower_envelope`.
struct LowerEnvelopeOptions {
  double cell_m = 0.5;     ///< m; finest cell of the surface.
  double coarsest_m = 16;  ///< m; coarsest cell, which must reach ground beside the widest object.
  double low_quantile = 0.05;  ///< Quantile of a cell's heights that represents it; with few points
                               ///< it is the lowest.
  double slope = 0.5;          ///< Steepest rise of the first guess; steeper ground is still found.
  double bend = 0.075;    ///< Tolerance s of a cell of side c: bend · c^1.5 (m), at least band_m.
  double band_m = 0.15;   ///< m; least tolerance of the surface.
  double above_m = 0.15;  ///< m; ground is at most this far above the surface, along its normal.
  double below_m = 0.4;   ///< m; ground is at most this far below the surface, along its normal.
  /// Ground is a layer: about a point of it, at most a cell away, the densest 10 cm near the
  /// surface are at least this many times as dense in points as the 15 cm above them. Tall grass
  /// and foliage without ground below have no layer. 0 = no such demand.
  double layer = 3;
};

/// Flags as ground (1) the points in a band about the smooth lower envelope of a tile, others as 0.
/// `points` are those of one tile with its margin (m, z up); a point that is not finite is not
/// ground.
///
/// The envelope is found from coarse cells to fine ones. In each cell a plane is fitted by weighted
/// least squares to the low points of the cells around, with the coarser plane as prior. Points
/// above lose weight as exp(−(r/s)²), with a tolerance s that shrinks with the cell; points below
/// gain weight. Pits that no neighbour shares are left out. Time and memory grow with points + area
/// / cell².
///
/// Throws `std::invalid_argument` where a parameter is not positive (`layer`: negative) or the tile
/// exceeds 2²⁶ cells.
std::vector<uint8_t> lower_envelope(std::span<const Vec3f> points,
                                    const LowerEnvelopeOptions& options = {});

/// The method of ground segmentation, and the options of all methods.
struct SegmentOptions {
  /// "lower_envelope", "spherical_variance", or "none" (no point is ground).
  std::string method = "lower_envelope";
  LowerEnvelopeOptions lower_envelope;
  SphericalVarianceOptions spherical_variance;
};

/// Flags ground points by the method that `options` names. Throws `std::invalid_argument` for an
/// unknown name.
std::vector<uint8_t> segment(std::span<const Vec3f> points, const SegmentOptions& options = {});

}  // namespace ground
}  // namespace underbrush
