#include "underbrush/fit/maximisation.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

// The longest moves of one step: of ln κ, of the mean in standard deviations, and of an entry of E.
constexpr double kLongestDensity = 1, kLongestShift = 0.5, kLongestStretch = 0.3;
constexpr double kLeastDensity = 1e-4, kMostDensity = 1e4;  // 1/m

/// How much more new points spread about a fit of k parameters than the n points that it was fitted
/// to, as a ratio of variances.
double spread_again(double n, double k) {
  return k > 0 ? std::min((n + k) / std::max(n - k, 1e-9), 4.0) : 1;
}

uint32_t count(double x) { return uint32_t(std::llround(std::clamp(x, 0.0, 4e9))); }

double clamped(double value, double longest) { return std::clamp(value, -longest, longest); }

/// Computes √(2π) σ e^{−δ²/2}, m, of a beam at distance δ through a sphere of the ellipsoid's
/// volume.
double depth_m(const Mat3& covariance, double delta) {
  return std::sqrt(2 * M_PI) * std::pow(covariance.determinant(), 1.0 / 6) *
         std::exp(-0.5 * delta * delta);
}

double moved_density(const elements::Ellipsoid& e, const Mat3& covariance,
                     const EllipsoidSums& sums, const MaximisationOptions& o, double stride) {
  const double depth = double(e.density_per_m) * depth_m(covariance, o.opaque_distance);
  const double odds = depth < 1e-8 ? 1 : depth / std::expm1(depth);
  const double slope = sums.density_slope + o.opaque_hits * odds;
  const double curvature = sums.density_curvature + o.opaque_hits * (odds * depth + 0.05) + 1e-3;
  const double move = stride * clamped(slope / curvature, kLongestDensity);
  return std::clamp(double(e.density_per_m) * std::exp(move), kLeastDensity, kMostDensity);
}

void move_geometry(elements::Ellipsoid& e, const Mat3& covariance, const EllipsoidSums& sums,
                   const MaximisationOptions& o, double stride) {
  const Mat3 root = Eigen::LLT<Mat3>(covariance).matrixL(), whiten = root.inverse();
  const Mat3 identity = Mat3::Identity();
  Vec3 shift = (sums.shift_curvature + 0.5 * identity).ldlt().solve(sums.shift_slope);
  if (shift.norm() > kLongestShift) shift *= kLongestShift / shift.norm();
  const double spread = spread_again(sums.hits, o.spent_points) - 1;
  // The prior adds −ν/2 (ln |Σ| + v tr Σ⁻¹) with the mean variance v.
  const double variance = covariance.trace() / 3, nu = o.prior_points;
  const Mat3 slope = sums.stretch_slope + spread * sums.along -
                     nu * (identity - variance * whiten * whiten.transpose());
  // An entry off the diagonal is one parameter that stands twice in E: its slope is twice that of
  // the entry alone, and its curvature four times.
  Mat3 curvature = 2 * sums.stretch_curvature + Mat3::Constant(2 * nu + 1e-3);
  curvature.diagonal() -= sums.stretch_curvature.diagonal();
  Mat3 stretch = slope.cwiseQuotient(curvature);
  if (stretch.norm() > kLongestStretch) stretch *= kLongestStretch / stretch.norm();
  const Mat3 moved = root * (identity + stride * stretch);
  e.mean += (stride * root * shift).cast<float>();
  e.set_covariance(elements::floored_covariance(moved * moved.transpose(), o.floor_m));
}

elements::HitCount counted(double p, double hits, double passes) {
  return {float(p), count(hits), count(passes)};
}

void move_noise(elements::TriangleMesh& mesh, const NoiseSums& sums, double stride) {
  double* sigma[2] = {&mesh.range_sigma_m, &mesh.roughness_m};
  for (size_t j = 0; j < 2; ++j) {
    if (!(sums.curvature[j] > 0)) continue;
    const double move = clamped(sums.slope[j] / sums.curvature[j], 0.5);
    *sigma[j] = std::max(*sigma[j] * std::exp(stride * move), 1e-3);
  }
}

}  // namespace

elements::Model with_densities(const elements::Model& model, double range_noise_m,
                               const MaximisationOptions& options) {
  elements::Model out = model;
  for (elements::TriangleMesh* mesh : {&out.ground, &out.surface}) {
    if (mesh->size() == 0 || mesh->roughness_m > 0) continue;
    mesh->roughness_m = std::max(mesh->range_sigma_m, range_noise_m);
    mesh->range_sigma_m = range_noise_m;
  }
  for (elements::Ellipsoid& e : out.ellipsoids) {
    if (e.density_per_m > 0) continue;
    e.set_covariance(spread_again(e.hit.hits, options.spent_at_start) * e.covariance_matrix());
    const double p = std::clamp(double(e.hit.p), 1e-3, 0.98);
    e.density_per_m = float(std::clamp(-std::log1p(-p) / depth_m(e.covariance_matrix(), 1),
                                       kLeastDensity, kMostDensity));
  }
  return out;
}

elements::Model sharpened(const elements::Model& model, double sharpness) {
  elements::Model out = model;
  out.tau *= std::sqrt(sharpness);
  for (elements::Ellipsoid& e : out.ellipsoids) {
    const Mat3 covariance = e.covariance_matrix(), narrow = covariance / sharpness;
    e.set_covariance(narrow);
    if (!(e.density_per_m > 0)) continue;
    const double depth = double(e.density_per_m) * depth_m(covariance, 0);
    const double sharp = M_LN2 * std::pow(depth / M_LN2, sharpness);
    e.density_per_m = float(std::clamp(sharp / depth_m(narrow, 0), 1e-12, 1e12));
  }
  return out;
}

elements::Model maximised(const elements::Model& model, const ElementSums& sums,
                          const MaximisationOptions& options, double stride) {
  elements::Model out = model;
  const size_t meshes = model.size() - model.ellipsoids.size();
  for (size_t i = 0; i < meshes; ++i) {
    const TriangleSums s = sums.triangle(i);
    const double hits = s.hits + options.triangle.a;
    const double all = hits + s.passes + options.triangle.b;
    const double old = model.hit(i).p, p = all > 0 ? hits / all : 1;
    out.hit(i) = counted(old + stride * (p - old), s.hits, s.passes);
  }
  move_noise(out.ground, sums.noise(elements::Kind::kGround), stride);
  move_noise(out.surface, sums.noise(elements::Kind::kSurface), stride);
  parallel_for(model.ellipsoids.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const EllipsoidSums s = sums.ellipsoid(i);
      elements::Ellipsoid& e = out.ellipsoids[i];
      const Mat3 covariance = e.covariance_matrix();
      const double all = s.hits + s.passes;
      e.hit = counted(all > 0 ? std::clamp(s.hits / all, 0.0, 1.0) : 1, s.hits, s.passes);
      e.density_per_m = float(moved_density(e, covariance, s, options, stride));
      if (s.hits > 1) move_geometry(e, covariance, s, options, stride);
    }
  });
  return out;
}

}  // namespace underbrush::fit
