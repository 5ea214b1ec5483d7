#include "underbrush/surface/implicit.hpp"

#include <cmath>

namespace underbrush::surface {
namespace {

constexpr float kSigmaNormal = 0.75f;
constexpr float kSigmaResidual = 0.25f;  // As a share of the mean radius.
constexpr int kFits = 8;
constexpr float kSettled = 1e-3f;  // As a share of the mean radius.

}  // namespace

float weight(const Vec3f& x, const OrientedPoint& p) {
  const float u = 1 - (x - p.position).squaredNorm() / (p.radius_m * p.radius_m);
  return u > 0 ? u * u * u * u : 0;
}

float imls(const Vec3f& x, std::span<const OrientedPoint> near) {
  float sum = 0, weights = 0;
  for (const OrientedPoint& p : near) {
    const float w = weight(x, p);
    sum += w * p.normal.dot(x - p.position);
    weights += w;
  }
  return weights > 0 ? sum / weights : NAN;
}

float rimls(const Vec3f& x, std::span<const OrientedPoint> near) {
  float radius = 0;
  for (const OrientedPoint& p : near) radius += p.radius_m;
  radius /= float(near.size());
  const float per_residual = 1 / (kSigmaResidual * radius);
  float f = NAN;
  Vec3f gradient = Vec3f::Zero();
  for (int fit = 0; fit < kFits; ++fit) {
    float weights = 0, sum = 0;
    Vec3f weights_slope = Vec3f::Zero(), sum_slope = Vec3f::Zero(), normals = Vec3f::Zero();
    for (const OrientedPoint& p : near) {
      const Vec3f d = x - p.position;
      const float per_square = 1 / (p.radius_m * p.radius_m);
      const float u = 1 - d.squaredNorm() * per_square;
      if (u <= 0) continue;
      const float height = p.normal.dot(d);
      float trust = 1;
      if (fit > 0) {
        const float r = (height - f) * per_residual;
        trust =
            std::exp(-r * r - (p.normal - gradient).squaredNorm() / (kSigmaNormal * kSigmaNormal));
      }
      const float w = trust * u * u * u * u;
      const Vec3f slope = -8 * trust * u * u * u * per_square * d;
      weights += w;
      weights_slope += slope;
      sum += w * height;
      sum_slope += slope * height;
      normals += w * p.normal;
    }
    if (!(weights > 0)) return f;  // All points are outliers to the last fit, which stands.
    const float before = f;
    f = sum / weights;
    gradient = (sum_slope - f * weights_slope + normals) / weights;
    if (std::abs(f - before) < kSettled * radius) break;
  }
  return f;
}

}  // namespace underbrush::surface
