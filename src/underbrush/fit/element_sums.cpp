#include "underbrush/fit/element_sums.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

constexpr double kNegligible = 1e-7;  // a share of a beam too small to count

// Row and column of the entries of a symmetric matrix's upper triangle, in the order in which a
// model stores covariances.
constexpr int kRow[6] = {0, 0, 0, 1, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 2};

enum Field : size_t {
  kHits,
  kPasses,
  kLoss,
  kDensitySlope,
  kDensityCurvature,
  kShiftSlope,
  kShiftCurvature = kShiftSlope + 3,
  kStretchSlope = kShiftCurvature + 6,
  kStretchCurvature = kStretchSlope + 6,
  kAlong = kStretchCurvature + 6
};

template <size_t kSize>
Mat3 symmetric(const std::array<FixedSum, kSize>& sums, size_t first) {
  Mat3 m;
  for (int k = 0; k < 6; ++k) {
    m(kRow[k], kColumn[k]) = m(kColumn[k], kRow[k]) = sums[first + size_t(k)].value();
  }
  return m;
}

}  // namespace

void FixedSum::add(double term) {
  const int64_t fixed = std::llrint(std::clamp(term, -1e4, 1e4) * 0x1p26);
  if (fixed) std::atomic_ref<int64_t>(bits_).fetch_add(fixed, std::memory_order_relaxed);
}

ElementSums::ElementSums(const elements::Model& model)
    : model_(&model),
      frames_(model.ellipsoids.size()),
      triangles_(model.size() - model.ellipsoids.size()),
      ellipsoids_(model.ellipsoids.size()) {
  parallel_for(frames_.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const elements::Ellipsoid& e = model.ellipsoids[i];
      const Mat3 root = Eigen::LLT<Mat3>(e.covariance_matrix()).matrixL();
      frames_[i] = {model.origin + e.mean.cast<double>(), root.inverse()};
    }
  });
}

void ElementSums::add(const Ray& ray, std::span<const trace::Intersection> met, double range_m,
                      const Responsibilities& shares) {
  const size_t meshes = triangles_.size();
  for (size_t k = 0; k < met.size(); ++k) {
    const trace::Intersection& m = met[k];
    const double hit = shares.hit[k], pass = shares.pass[k];
    if (hit < kNegligible && pass < kNegligible) continue;
    if (m.element >= meshes) {
      add_ellipsoid(ray, m, range_m, hit, pass, -shares.log_likelihood);
      continue;
    }
    triangles_[m.element][0].add(hit);
    triangles_[m.element][1].add(pass);
    if (hit < kNegligible) continue;
    const bool ground = model_->kind(m.element) == elements::Kind::kGround;
    const double own = (ground ? model_->ground : model_->surface).range_sigma_m;
    const double variance = m.sigma_m * m.sigma_m, residual = range_m - m.t_m;
    const double misfit = residual * residual / variance - 1;
    const double share[2] = {own * own / variance, 1 - own * own / variance};
    for (size_t j = 0; j < 2; ++j) {
      noise_[!ground][j].add(hit * misfit * share[j]);
      noise_[!ground][2 + j].add(hit * 2 * share[j] * share[j]);
    }
  }
}

// Adds the derivatives of a beam's log-likelihood by ln κ, s and E. Its optical depth a = κ √(2π) σ
// e^{−δ²/2} changes by
//   ∂ ln a = k + c·s + nᵀEn + cᵀEc
// with the whitened direction n and the whitened point of closest approach c. The misfit x = (z −
// t)/σ changes by ∂x = −n·s − 2 nᵀEc − x nᵀEn, and σ by ∂ ln σ = nᵀEn. The log-likelihood of the
// beam is r [ln(1 − e^{−a}) − ln σ − x²/2] − (the share that went through) a.
void ElementSums::add_ellipsoid(const Ray& ray, const trace::Intersection& met, double range_m,
                                double hit, double pass, double loss) {
  const size_t at = met.element - triangles_.size();
  const Frame& frame = frames_[at];
  const double depth = double(model_->ellipsoids[at].density_per_m) * std::sqrt(2 * M_PI) *
                       met.sigma_m * std::exp(-0.5 * met.delta2);
  // `odds` is a / (eᵃ − 1); odds × a is the Fisher information in ln a of a trial with p = 1 − e⁻ᵃ.
  const double odds = depth < 1e-8 ? 1 : depth / std::expm1(depth);
  const double slope = hit * odds - pass * depth, weight = (hit + pass) * odds * depth;
  const Vec3 direction = frame.whiten * ray.direction;
  const Vec3 n = direction * met.sigma_m;
  const Vec3 c = frame.whiten * (ray.origin - frame.mean) + met.t_m * direction;
  const double x = hit < kNegligible ? 0 : (range_m - met.t_m) / met.sigma_m;
  std::array<FixedSum, kFields>& sums = ellipsoids_[at];
  sums[kHits].add(hit);
  sums[kPasses].add(pass);
  sums[kLoss].add(hit * loss);
  sums[kDensitySlope].add(slope);
  sums[kDensityCurvature].add(weight);
  for (int k = 0; k < 3; ++k) sums[kShiftSlope + size_t(k)].add(slope * c[k] + hit * x * n[k]);
  for (size_t k = 0; k < 6; ++k) {
    const int i = kRow[k], j = kColumn[k];
    const double nn = n[i] * n[j], cc = c[i] * c[j], nc = n[i] * c[j] + c[i] * n[j];
    sums[kShiftCurvature + k].add(weight * cc + hit * nn);
    sums[kStretchSlope + k].add(slope * (nn + cc) + hit * ((x * x - 1) * nn + x * nc));
    sums[kStretchCurvature + k].add(weight * (nn + cc) * (nn + cc) + hit * (nc * nc + 2 * nn * nn));
    sums[kAlong + k].add(hit * x * x * nn);
  }
}

TriangleSums ElementSums::triangle(size_t element) const {
  return {triangles_[element][0].value(), triangles_[element][1].value()};
}

EllipsoidSums ElementSums::ellipsoid(size_t index) const {
  const std::array<FixedSum, kFields>& sums = ellipsoids_[index];
  EllipsoidSums out;
  out.hits = sums[kHits].value();
  out.passes = sums[kPasses].value();
  out.loss = sums[kLoss].value();
  out.density_slope = sums[kDensitySlope].value();
  out.density_curvature = sums[kDensityCurvature].value();
  for (int k = 0; k < 3; ++k) out.shift_slope[k] = sums[kShiftSlope + size_t(k)].value();
  out.shift_curvature = symmetric(sums, kShiftCurvature);
  out.stretch_slope = symmetric(sums, kStretchSlope);
  out.stretch_curvature = symmetric(sums, kStretchCurvature);
  out.along = symmetric(sums, kAlong);
  return out;
}

NoiseSums ElementSums::noise(elements::Kind mesh) const {
  const std::array<FixedSum, 4>& sums = noise_[mesh != elements::Kind::kGround];
  return {{sums[0].value(), sums[1].value()}, {sums[2].value(), sums[3].value()}};
}

size_t ElementSums::bytes() const {
  return frames_.size() * (sizeof(Frame) + sizeof(ellipsoids_[0])) +
         triangles_.size() * sizeof(triangles_[0]);
}

}  // namespace underbrush::fit
