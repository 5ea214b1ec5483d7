#include "underbrush/core/leaf_angle_distribution.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush {

LeafAngleDistribution::LeafAngleDistribution(double shape) : shape2_(shape * shape) {
  require(shape >= 0.01 && shape <= 100, "foliage: the shape must be 0.01 to 100");
  const double b = 1 - shape2_;  // positive for upright leaves
  if (std::abs(b) < 1e-4) {      // where the closed forms below are 0/0
    lambda_ = 2 + 2.0 / 3 * (shape - 1);
    vertical2_ = 1.0 / 3 + 16.0 / 45 * (shape - 1);
    return;
  }
  const double e = std::sqrt(std::abs(b));
  // J = ∫₀¹ dc / (χ² + (1 − χ²) c²)
  const double j = b > 0 ? std::atan(e / shape) / (shape * e) : std::atanh(e / shape) / (shape * e);
  lambda_ = b > 0 ? shape + std::asin(e) / e : shape + std::atanh(e / shape) / e;
  vertical2_ = 2 * shape2_ * shape / lambda_ * (j - 1) / (2 * b);
}

double LeafAngleDistribution::projection(double cos_zenith) const {
  return 0.5 * std::sqrt(level() + slope() * (cos_zenith * cos_zenith));
}

double LeafAngleDistribution::backscatter(double cos_zenith) const {
  const double c2 = cos_zenith * cos_zenith;
  return (c2 * vertical2_ + 0.5 * (1 - c2) * (1 - vertical2_)) / projection(cos_zenith);
}

double LeafAngleDistribution::density(double zenith_rad) const {
  const double c = std::cos(zenith_rad), s = std::sin(zenith_rad), d = c * c + shape2_ * s * s;
  return 2 * shape2_ * std::sqrt(shape2_) * s / (lambda_ * d * d);
}

}  // namespace underbrush
