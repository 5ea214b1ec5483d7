/// \file
/// Which points of a tile are ground. Two methods of one shape: points in, one flag a point out.
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

/// Parameters of `spherical_variance`; the defaults are those of [tallavajhula18]'s authors.
struct SphericalVarianceOptions {
  int neighbours = 10;     ///< At most this many nearest neighbours (itself included) ...
  double radius_m = 5;     ///< ... within this distance: the ball d_φ.
  int min_neighbours = 4;  ///< N_min: with fewer, φ = `default_variance`.
  double default_variance = 0.01;
  int smooth_neighbours = 100;  ///< Neighbours that φ is averaged over; 0 = not smoothed.
  double smooth_radius_m = 10;  ///< At most this far, ...
  double smooth_scale_m = 10;   ///< ... with weight exp(−d²/scale²).
  double threshold = 0.09;      ///< Ground iff φ is below.
};

/// φ = λ1 / (λ1 + λ2 + λ3), λ1 ≤ λ2 ≤ λ3 the eigenvalues of the covariance of each point's
/// neighbours ([tallavajhula18] §IV): 0 for a plane, 1/3 for a ball. Smoothed as asked. NaN for a
/// point that is not finite.
std::vector<float> spherical_variances(std::span<const Vec3f> points,
                                       const SphericalVarianceOptions& options = {});

/// Ground (1) where φ < threshold ([tallavajhula18] §IV), else 0. Flat walls count as ground: this
/// is the paper's method, for natural terrain.
std::vector<uint8_t> spherical_variance(std::span<const Vec3f> points,
                                        const SphericalVarianceOptions& options = {});

/// Parameters of `lower_envelope`.
struct LowerEnvelopeOptions {
  double cell_m = 0.5;         ///< Finest cell of the surface.
  double coarsest_m = 16;      ///< Coarsest: must reach ground beside the widest object.
  double low_quantile = 0.05;  ///< Height in a cell that stands for it (of few points: the lowest).
  double slope = 0.5;          ///< Steepest rise of the first guess; steeper ground is still found.
  double bend = 0.075;   ///< Tolerance s of a cell of side c: bend · c^1.5 (m), at least band_m.
  double band_m = 0.15;  ///< Ground is at most this far above the surface (along its normal) ...
  double below_m = 0.4;  ///< ... and at most this far below it.
};

/// Ground (1) where a point lies in a band about the smooth lower envelope of the tile, else 0.
/// The envelope is found from coarse cells to fine ones: in each, a plane is fitted by weighted
/// least squares to the low points of the cells around, with the coarser plane as prior; points
/// above lose their weight as exp(−(r/s)²) with a tolerance s that shrinks with the cell, points
/// below gain; pits that no neighbour shares are left out. Time and memory: points + area / cell².
/// Points: one tile with margin, m, z up; a point that is not finite is not ground. Throws
/// `std::invalid_argument` where a parameter is not positive or the tile exceeds 2²⁶ cells.
std::vector<uint8_t> lower_envelope(std::span<const Vec3f> points,
                                    const LowerEnvelopeOptions& options = {});

/// All methods' parameters, and which method.
struct SegmentOptions {
  /// Or "spherical_variance", or "none": no point is ground.
  std::string method = "lower_envelope";
  LowerEnvelopeOptions lower_envelope;
  SphericalVarianceOptions spherical_variance;
};

/// The method of that name. Throws `std::invalid_argument` for another name.
std::vector<uint8_t> segment(std::span<const Vec3f> points, const SegmentOptions& options = {});

}  // namespace ground
}  // namespace underbrush
