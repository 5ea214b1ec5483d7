/// \file
/// This file compares two point clouds that share no beams, such as scans of a real and of a
/// simulated scanner with other directions.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/cells.hpp"
#include "underbrush/metrics/summary.hpp"

namespace underbrush::metrics {

/// A pair of values: of the real cloud and of the simulated one.
template <class T>
using RealAndSimulated = std::array<T, 2>;

/// The distribution of a length in both clouds.
struct LengthDistribution {
  double first_m = 0, bin_m = 1;  ///< Lower edge of the first bin, and the width of all bins, m.
  RealAndSimulated<std::vector<double>> share;  ///< The share of the points in each bin.
  /// The first Wasserstein distance of the two distributions, m: ∫ |F(x) − G(x)| dx of their
  /// cumulative distributions.
  double distance_m = kUnknown;
};

/// The clouds in one square of the plane.
struct CloudRegion {
  Cell2 at;  ///< The square, of the side `CloudScores::kRegionM`.
  RealAndSimulated<size_t> points{};
  /// As in `CloudScores`, for the points in the square, whose nearest points may lie outside; for
  /// one direction alone where a cloud has no point in the square.
  double cloud_error_m = kUnknown;
  double error_share = 0;  ///< The share of the sum of all distances.
  /// `CloudScores::height`; NaN where a cloud has no point in the square.
  double height_distance_m = kUnknown;
};

/// The similarity of two clouds. A score without data is NaN.
struct CloudScores {
  static constexpr double kRegionM = 20;  ///< Side of a region, m.
  static constexpr double kGroundM = 2;   ///< Side of the squares that have a lowest point, m.
  static constexpr double kCellM = 0.25;  ///< Side of a cell of `occupied`, m.

  RealAndSimulated<size_t> beams{}, points{};
  /// The share of the beams without a return, with one, with two, and with more.
  RealAndSimulated<std::array<double, 4>> returns{};
  /// The mean distance of each cloud's points from the nearest point of the other one, m: a measure
  /// of the real points that were missed, and of the simulated ones that were made up.
  RealAndSimulated<double> nearest_m{kUnknown, kUnknown};
  double cloud_error_m = kUnknown;          ///< Mean of `nearest_m`, [tallavajhula18] eq. 4–5.
  double density_aware_chamfer = kUnknown;  ///< As in `Summary`.
  /// The cells with points of both clouds over those with points of either.
  double occupied = kUnknown;
  LengthDistribution range;
  /// The height is counted from the lowest real point of the same square. Points in squares without
  /// real points have none.
  LengthDistribution height;
  std::vector<CloudRegion> regions;  ///< In the order of `at`.
};

/// A comparison, and the name of its simulated log.
struct NamedCloudScores {
  std::string name;
  CloudScores scores;
};

/// Compares two clouds in one frame. Rows that are echoes of one beam count as its returns. Points
/// and ranges are kept, not beams: about 35 bytes a point. `progress(done, total)` may be empty.
/// Throws `DataError` where one of the clouds has no point.
CloudScores compare_clouds(BeamSource& real, BeamSource& simulated,
                           const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::metrics
