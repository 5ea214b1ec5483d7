/// \file
/// This file estimates the noise of ranges on a mesh from residuals along the beam.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::credit {

/// The residuals of the returns of a mesh along their beams, by angle of incidence.
///
/// Ranges at the angle of incidence θ have the variance σ_r² + (h / |cos θ|)²
/// (`elements::TriangleMesh`). σ_r and h are those of greatest likelihood for a normal distribution
/// that ends at the largest residual, with a share of outliers that are even over it.
class MeshResiduals {
 public:
  /// Residuals up to `most_m` (m) count.
  explicit MeshResiduals(double most_m);

  /// Counts a return on a triangle whose beam has the direction `direction` and ended `residual_m`
  /// (m) from it. Any number of threads may add.
  void add(const elements::TriangleMesh& mesh, uint32_t triangle, const Vec3& direction,
           double residual_m);

  /// Adds counts that `counts` returned, of residuals up to the same limit. Throws
  /// `std::invalid_argument` for another number of them.
  void add(std::span<const uint32_t> counts);
  /// The returns by angle of incidence and residual; their number is always the same.
  std::vector<uint32_t> counts() const;

  /// σ_r and h, m.
  struct Noise {
    double range_sigma_m = 0, roughness_m = 0;
  };
  /// Estimates the noise, or nothing from fewer than 200 returns. σ_r is at least `least_m` (m).
  std::optional<Noise> noise(double least_m) const;

 private:
  static constexpr size_t kIncidences = 24, kResiduals = 150;
  /// A mean of 1 / cos² θ of each row of counts.
  double per_cos2(size_t incidence) const;

  double most_m_;
  std::vector<std::atomic<uint32_t>> count_;  ///< kIncidences × kResiduals.
};

/// Gives a mesh the noise of its residuals, where there are enough of them.
void set_noise(elements::TriangleMesh& mesh, const MeshResiduals& residuals, double least_m);

}  // namespace underbrush::credit
