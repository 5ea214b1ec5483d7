#include "underbrush/likelihood/maximisation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::likelihood {
namespace {

// The longest moves of one step: of ln κ, of the mean in standard deviations, of an entry of E, and
// of the logarithms of a mesh's range noise and a triangle's roughness.
constexpr double kLongestDensity = 1, kLongestShift = 0.5, kLongestStretch = 0.3;
constexpr double kLongestNoise = 0.5, kLongestRoughness = 1;
constexpr double kLeastNoise = 1e-3;                        // m, of both
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

/// The evidence of the beams of a pass for the density of an ellipsoid. In ln κ the slope of the
/// likelihood of a medium is hits − κ path, so that the path follows from it.
Evidence evidence_of(const elements::Ellipsoid& e, const EllipsoidSums& sums) {
  const double depth = std::max(0.0, sums.hits - sums.density_slope);
  return {sums.hits, depth / double(e.density_per_m)};
}

/// The prior of the density is a gamma distribution of mean κ₀, that of the neighbourhood, with the
/// weight of ν hits. It adds ν (ln κ − κ/κ₀) to the log-likelihood.
double moved_density(const elements::Ellipsoid& e, const EllipsoidSums& sums,
                     const Neighbourhood& prior, const MaximisationOptions& o, double stride) {
  const double nu = prior.density_per_m > 0 ? o.prior_hits : 0;
  const double ratio = nu > 0 ? double(e.density_per_m) / prior.density_per_m : 1;
  const double slope = sums.density_slope + nu * (1 - ratio);
  const double curvature = sums.density_curvature + nu * ratio + 1e-3;
  const double move = stride * clamped(slope / curvature, kLongestDensity);
  return std::clamp(double(e.density_per_m) * std::exp(move), kLeastDensity, kMostDensity);
}

/// Moves mean and covariance. The density follows, so that the optical depth of the beams that the
/// ellipsoid returned stays.
void move_geometry(elements::Ellipsoid& e, const Mat3& covariance, const EllipsoidSums& sums,
                   const Mat3& prior, const Eigen::Matrix3f* open, const MaximisationOptions& o,
                   double stride) {
  const Mat3 root = cholesky(covariance), whiten = root.inverse();
  const Mat3 identity = Mat3::Identity();
  Vec3 shift = solve(sums.shift_curvature + 0.5 * identity, sums.shift_slope);
  if (shift.norm() > kLongestShift) shift *= kLongestShift / shift.norm();
  const double spread = spread_again(sums.hits, o.spent_points) - 1;
  // The prior Σ₀ adds −ν/2 (ln |Σ| + tr Σ₀ Σ⁻¹).
  const double nu = o.prior_points;
  const Mat3 slope = sums.stretch_slope + spread * sums.along -
                     nu * (identity - whiten * prior * whiten.transpose());
  // An entry off the diagonal is one parameter that stands twice in E: its slope is twice that of
  // the entry alone, and its curvature four times.
  Mat3 curvature = 2 * sums.stretch_curvature + Mat3::Constant(2 * nu + 1e-3);
  curvature.diagonal() -= sums.stretch_curvature.diagonal();
  Mat3 stretch = slope.cwiseQuotient(curvature);
  if (stretch.norm() > kLongestStretch) stretch *= kLongestStretch / stretch.norm();
  const Mat3 moved = root * (identity + stride * stretch);
  e.mean += (stride * root * shift).cast<float>();
  const Mat3 sigma = moved * moved.transpose();
  e.set_covariance(open ? elements::floored_covariance(
                              sigma, open->cast<double>() + o.floor_m * o.floor_m * identity)
                        : elements::floored_covariance(sigma, o.floor_m));
  // Beams of the whitened direction n find σ changed by the factor e^(nᵀEn).
  const double along = stretch.cwiseProduct(sums.along).sum() / std::max(sums.along.trace(), 1e-9);
  e.density_per_m = float(
      std::clamp(double(e.density_per_m) * std::exp(-stride * along), kLeastDensity, kMostDensity));
}

elements::HitCount counted(double p, double hits, double passes) {
  return {float(p), count(hits), count(passes)};
}

void move_range_noise(elements::TriangleMesh& mesh, const NoiseSums& sums, double stride) {
  if (!(sums.curvature > 0)) return;
  const double move = clamped(sums.slope / sums.curvature, kLongestNoise);
  mesh.range_sigma_m = std::max(mesh.range_sigma_m * std::exp(stride * move), kLeastNoise);
}

/// Moves the roughness of each triangle; `first` is the element number of the first one. That of
/// the mesh becomes their mean over hits, of the logarithms.
void move_roughness(elements::TriangleMesh& mesh, size_t first, const ElementSums& sums,
                    const MaximisationOptions& o, double stride) {
  if (mesh.size() == 0 || !(mesh.roughness_m > 0)) return;
  if (mesh.roughness.empty()) mesh.roughness.assign(mesh.size(), float(mesh.roughness_m));
  const double nu = o.roughness_hits;
  double logs = 0, hits = 0;
  for (size_t k = 0; k < mesh.size(); ++k) {
    const TriangleSums s = sums.triangle(first + k);
    const double h = double(mesh.roughness[k]), ratio = mesh.roughness_m / h;
    // The prior adds −ν/2 (ln h² + h₀²/h²) with the roughness h₀ of the mesh.
    const double slope = s.roughness_slope + nu * (ratio * ratio - 1);
    const double curvature = s.roughness_curvature + 2 * nu + 1e-9;
    const double move = stride * clamped(slope / curvature, kLongestRoughness);
    mesh.roughness[k] = float(std::max(h * std::exp(move), kLeastNoise));
    logs += s.hits * std::log(double(mesh.roughness[k]));
    hits += s.hits;
  }
  if (hits > 0) mesh.roughness_m = std::exp(logs / hits);
}

/// Takes from the range noise of a mesh what is more than the sensor's. It was found together with
/// one roughness for all triangles, and so has the differences between them. The roughness becomes
/// greater, so that the variance stays at the usual |cos θ| of ground.
void part_noise(elements::TriangleMesh& mesh, double range_noise_m) {
  constexpr double kUsualCos = 0.2;
  const double excess =
      std::max(0.0, mesh.range_sigma_m * mesh.range_sigma_m - range_noise_m * range_noise_m);
  mesh.roughness_m =
      std::sqrt(mesh.roughness_m * mesh.roughness_m + kUsualCos * kUsualCos * excess);
  mesh.range_sigma_m = std::min(mesh.range_sigma_m, range_noise_m);
}

}  // namespace

elements::Model with_densities(const elements::Model& model, double range_noise_m,
                               const MaximisationOptions& options) {
  elements::Model out = model;
  for (elements::TriangleMesh* mesh : {&out.ground, &out.surface}) {
    if (mesh->size() == 0 || !mesh->roughness.empty()) continue;
    if (mesh->roughness_m > 0) {
      part_noise(*mesh, range_noise_m);
    } else {
      mesh->roughness_m = std::max(mesh->range_sigma_m, range_noise_m);
      mesh->range_sigma_m = range_noise_m;
    }
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

elements::Model calibrated(const elements::Model& model, const ElementSums& held_out) {
  constexpr std::array kShares{0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0};
  constexpr double kPriorHits = 100;
  const auto bin_of = [&](const elements::Ellipsoid& e) {
    const auto above = std::lower_bound(kShares.begin(), kShares.end() - 1, double(e.hit.p));
    return size_t(above - kShares.begin());
  };
  std::array<double, kShares.size()> slope{}, curvature{};
  for (size_t i = 0; i < model.ellipsoids.size(); ++i) {
    const EllipsoidSums s = held_out.ellipsoid(i);
    const size_t bin = bin_of(model.ellipsoids[i]);
    slope[bin] += s.density_slope;
    curvature[bin] += s.density_curvature;
  }
  elements::Model out = model;
  for (elements::Ellipsoid& e : out.ellipsoids) {
    const size_t bin = bin_of(e);
    const double move = clamped(slope[bin] / (curvature[bin] + kPriorHits), kLongestDensity);
    e.density_per_m =
        float(std::clamp(double(e.density_per_m) * std::exp(move), kLeastDensity, kMostDensity));
  }
  return out;
}

elements::Model maximised(const elements::Model& model, const ElementSums& sums,
                          const Neighbours& neighbours, const MaximisationOptions& options,
                          double stride, std::span<const Eigen::Matrix3f> open) {
  elements::Model out = model;
  const size_t meshes = model.size() - model.ellipsoids.size();
  for (size_t i = 0; i < meshes; ++i) {
    const TriangleSums s = sums.triangle(i);
    const double hits = s.hits + options.triangle.a;
    const double all = hits + s.passes + options.triangle.b;
    const double old = model.hit(i).p, p = all > 0 ? hits / all : 1;
    out.hit(i) = counted(old + stride * (p - old), s.hits, s.passes);
  }
  move_range_noise(out.ground, sums.noise(elements::Kind::kGround), stride);
  move_range_noise(out.surface, sums.noise(elements::Kind::kSurface), stride);
  move_roughness(out.ground, 0, sums, options, stride);
  move_roughness(out.surface, out.ground.size(), sums, options, stride);
  std::vector<Evidence> evidence(model.ellipsoids.size());
  for (size_t i = 0; i < evidence.size(); ++i) {
    evidence[i] = evidence_of(model.ellipsoids[i], sums.ellipsoid(i));
  }
  const std::vector<Neighbourhood> priors = neighbours.neighbourhoods(model.ellipsoids, evidence);
  parallel_for(model.ellipsoids.size(), 256, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const EllipsoidSums s = sums.ellipsoid(i);
      elements::Ellipsoid& e = out.ellipsoids[i];
      const Mat3 covariance = e.covariance_matrix();
      const double all = s.hits + s.passes;
      e.hit = counted(all > 0 ? std::clamp(s.hits / all, 0.0, 1.0) : 1, s.hits, s.passes);
      e.density_per_m = float(moved_density(e, s, priors[i], options, stride));
      if (s.hits <= 1) continue;
      move_geometry(e, covariance, s, priors[i].shape, open.empty() ? nullptr : &open[i], options,
                    stride);
    }
  });
  return out;
}

}  // namespace underbrush::likelihood
