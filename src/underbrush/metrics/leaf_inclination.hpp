/// \file
/// How the leaves of a cloud stand, and whether it looks like real vegetation [goodin24].
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// The distribution of arccos n_z over the points of a cloud, in [0, π].
struct LeafInclination {
  static constexpr size_t kBins = 36;
  /// The middle of 44 field measurements, and the largest distance of one from it.
  static constexpr double kRealMean = 1.65, kRealSigma = 0.747, kLargest = 0.11;

  size_t points = 0;
  double mean_rad = 0, sigma_rad = 0;  ///< μ, σ.
  std::array<uint64_t, kBins> count{};

  /// ε = √((μ − 1.65)² + (σ − 0.747)²), rad.
  double epsilon() const;
  bool is_realistic() const { return epsilon() <= kLargest; }
  /// The largest difference between the shares below a bin's end and those of the Gaussian with the
  /// same μ and σ. The paper calls real clouds Gaussian and billboards and cartoons not, by eye;
  /// its criterion has μ and σ alone.
  double gaussian_gap() const;
};

/// Normals from the 30 nearest points, their signs those of `normals`: the distribution depends on
/// them. One frame, z up, m. Throws `std::invalid_argument` for fewer than 30 points.
LeafInclination leaf_inclination(std::span<const Vec3f> cloud);

/// ε = a − b ln n by least squares.
struct LogRegression {
  double a = 0, b = 0, r2 = 0;
  /// The n at which the line is at `epsilon`; infinite where b is not positive.
  double count_at(double epsilon) const;
};
/// Throws `std::invalid_argument` for fewer than three pairs, lengths that differ or counts that
/// are all the same.
LogRegression log_regression(std::span<const double> count, std::span<const double> epsilon);

}  // namespace underbrush::metrics
