#include "underbrush/test_site/leaf_angle.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::test_site {

double leaf_angle_density(LeafAngle angles, double zenith_rad) {
  const double t = zenith_rad;
  switch (angles) {
    case LeafAngle::kSpherical:
      return std::sin(t);
    case LeafAngle::kUniform:
      return M_2_PI;
    case LeafAngle::kPlanophile:
      return M_2_PI * (1 + std::cos(2 * t));
    case LeafAngle::kErectophile:
      return M_2_PI * (1 - std::cos(2 * t));
    case LeafAngle::kPlagiophile:
      return M_2_PI * (1 - std::cos(4 * t));
    case LeafAngle::kExtremophile:
      return M_2_PI * (1 + std::cos(4 * t));
  }
  throw std::invalid_argument("leaf angle: unknown distribution");
}

double leaf_angle_cdf(LeafAngle angles, double zenith_rad) {
  const double t = zenith_rad;
  switch (angles) {
    case LeafAngle::kSpherical:
      return 1 - std::cos(t);
    case LeafAngle::kUniform:
      return M_2_PI * t;
    case LeafAngle::kPlanophile:
      return M_2_PI * (t + std::sin(2 * t) / 2);
    case LeafAngle::kErectophile:
      return M_2_PI * (t - std::sin(2 * t) / 2);
    case LeafAngle::kPlagiophile:
      return M_2_PI * (t - std::sin(4 * t) / 4);
    case LeafAngle::kExtremophile:
      return M_2_PI * (t + std::sin(4 * t) / 4);
  }
  throw std::invalid_argument("leaf angle: unknown distribution");
}

double leaf_angle_quantile(LeafAngle angles, double u) {
  if (angles == LeafAngle::kSpherical) return std::acos(1 - u);
  double low = 0, high = M_PI_2;
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    (leaf_angle_cdf(angles, middle) < u ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Averages |cos| between a leaf normal at zenith t and a beam at zenith b over the azimuth, then
// over g.
double leaf_projection(LeafAngle angles, double beam_zenith_rad) {
  const double cos_b = std::abs(std::cos(beam_zenith_rad)), sin_b = std::sin(beam_zenith_rad);
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) * M_PI_2 / kSteps;
    const double c = cos_b * std::cos(t), s = std::abs(sin_b * std::sin(t));
    double seen = c;
    if (s > c) {
      const double turn = std::acos(-c / s);
      seen = c * (2 * turn / M_PI - 1) + M_2_PI * s * std::sin(turn);
    }
    sum += seen * leaf_angle_density(angles, t);
  }
  return sum * M_PI_2 / kSteps;
}

}  // namespace underbrush::test_site
