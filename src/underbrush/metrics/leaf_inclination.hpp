/// \file
/// This file measures leaf inclination in a cloud, and whether it is that of real vegetation
/// [goodin24].
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "underbrush/core/pose.hpp"

namespace underbrush::metrics {

/// The distribution of the leaf inclination arccos n_z over the points of a cloud, in [0, π].
struct LeafInclination {
  static constexpr size_t kBins = 36;
  /// The centre of 44 field measurements, and the greatest distance of one of them from it, rad.
  static constexpr double kRealMean = 1.65, kRealSigma = 0.747, kLargest = 0.11;

  size_t points = 0;
  double mean_rad = 0, sigma_rad = 0;  ///< μ, σ.
  std::array<uint64_t, kBins> count{};

  /// The distance from real vegetation, ε = √((μ − 1.65)² + (σ − 0.747)²), rad.
  double epsilon() const;
  bool is_realistic() const { return epsilon() <= kLargest; }
  /// The Kolmogorov–Smirnov distance to the Gaussian with the same μ and σ: the largest difference
  /// of cumulative shares at the ends of bins. [goodin24] calls real clouds Gaussian, and
  /// billboards and cartoons not, by eye; its criterion uses μ and σ alone.
  double gaussian_gap() const;
};

/// Computes the leaf inclination of a cloud (z up, m). Normals are those of `normals` with 30
/// neighbours; the distribution depends on their signs. Throws `std::invalid_argument` for fewer
/// than 30 points.
LeafInclination leaf_inclination(std::span<const Vec3f> cloud);

/// The line ε = a − b ln n, fitted by least squares.
struct LogRegression {
  double a = 0, b = 0, r2 = 0;
  /// The n at which the line reaches `epsilon`; infinite where b is not positive.
  double count_at(double epsilon) const;
};
/// Fits a `LogRegression`. Throws `std::invalid_argument` for fewer than three pairs, for lengths
/// that differ and for counts that are all equal.
LogRegression log_regression(std::span<const double> count, std::span<const double> epsilon);

}  // namespace underbrush::metrics
