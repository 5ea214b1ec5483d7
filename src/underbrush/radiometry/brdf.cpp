#include "underbrush/radiometry/brdf.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::radiometry {
namespace {

/// The coefficients A and B of Oren–Nayar for the roughness σ.
struct Rough {
  explicit Rough(double sigma)
      : a(1 - 0.5 * sigma * sigma / (sigma * sigma + 0.33)),
        b(0.45 * sigma * sigma / (sigma * sigma + 0.09)) {}
  double a, b;
};

double oren_nayar(double sigma, const Vec3& in, const Vec3& out, const Vec3& normal) {
  const Rough rough(sigma);
  const double cos_in = in.dot(normal), cos_out = out.dot(normal);
  const Vec3 flat_in = in - cos_in * normal, flat_out = out - cos_out * normal;
  const double sines = flat_in.norm() * flat_out.norm();
  const double turn = sines > 1e-12 ? std::max(0.0, flat_in.dot(flat_out) / sines) : 0;
  // sin α tan β with α the larger angle is sin θ_in sin θ_out divided by the cosine of the smaller
  // angle.
  return (rough.a + rough.b * turn * sines / std::max(cos_in, cos_out)) / M_PI;
}

}  // namespace

double brdf(const SurfaceModel& s, const Vec3& to_light, const Vec3& to_eye, const Vec3& normal) {
  const double cos_in = to_light.dot(normal);
  if (cos_in <= 0 || to_eye.dot(normal) <= 0) return 0;
  switch (s.brdf) {
    case Brdf::kLambert:
      break;
    case Brdf::kOrenNayar:
      return oren_nayar(s.roughness_rad, to_light, to_eye, normal);
    case Brdf::kPhong: {
      const double lobe = std::max(0.0, (2 * cos_in * normal - to_light).dot(to_eye));
      return (1 - s.gloss) / M_PI +
             s.gloss * (s.exponent + 2) / (2 * M_PI) * std::pow(lobe, s.exponent);
    }
  }
  return 1 / M_PI;
}

double backscatter(const SurfaceModel& s, double cos_incidence) {
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  if (c == 0) return 0;
  switch (s.brdf) {
    case Brdf::kLambert:
      break;
    case Brdf::kOrenNayar: {
      const Rough rough(s.roughness_rad);
      return rough.a * c + rough.b * (1 - c * c);
    }
    case Brdf::kPhong: {
      const double lobe = std::max(0.0, 2 * c * c - 1);
      return c * ((1 - s.gloss) + s.gloss * (s.exponent + 2) / 2 * std::pow(lobe, s.exponent));
    }
  }
  return c;
}

}  // namespace underbrush::radiometry
