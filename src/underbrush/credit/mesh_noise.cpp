#include "underbrush/credit/mesh_noise.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::credit {
namespace {

constexpr double kLeastCos = 0.01;  // as the ray model has it
constexpr uint64_t kLeastReturns = 200;

/// Logarithms of σ_r and h (m), and of the odds of an outlier.
using Parameters = std::array<double, 3>;

/// The parameters of the greatest value of f: each is moved up and down by steps that are halved
/// where none of them helps.
template <class F>
Parameters climbed(Parameters at, const Parameters& least, const F& f) {
  double best = f(at);
  for (double step = 1; step > 0.005;) {
    bool is_better = false;
    for (size_t k = 0; k < at.size(); ++k) {
      for (const double move : {step, -step}) {
        Parameters next = at;
        next[k] = std::max(at[k] + move, least[k]);
        if (const double value = f(next); value > best) {
          best = value;
          at = next;
          is_better = true;
        }
      }
    }
    if (!is_better) step /= 2;
  }
  return at;
}

}  // namespace

MeshResiduals::MeshResiduals(double most_m) : most_m_(most_m), count_(kIncidences * kResiduals) {
  require(most_m > 0, "mesh noise: the largest residual must be positive");
}

void MeshResiduals::add(const elements::TriangleMesh& mesh, uint32_t triangle,
                        const Vec3& direction, double residual_m) {
  const double size = std::abs(residual_m);
  if (!(size < most_m_)) return;
  std::array<Vec3, 3> at;
  for (size_t v = 0; v < 3; ++v) at[v] = mesh.vertices[mesh.triangles[triangle][v]].cast<double>();
  const Vec3 normal = (at[1] - at[0]).cross(at[2] - at[0]);
  const double cosine = std::abs(normal.dot(direction)) / std::max(normal.norm(), 1e-30);
  const double share = std::log(std::clamp(cosine, kLeastCos, 1.0)) / std::log(kLeastCos);
  const auto incidence = std::min(size_t(share * double(kIncidences)), kIncidences - 1);
  const auto residual = std::min(size_t(size / most_m_ * double(kResiduals)), kResiduals - 1);
  count_[incidence * kResiduals + residual].fetch_add(1, std::memory_order_relaxed);
}

void MeshResiduals::add(std::span<const uint32_t> counts) {
  require(counts.size() == count_.size(), "mesh noise: another number of counts");
  for (size_t k = 0; k < counts.size(); ++k) count_[k] += counts[k];
}

std::vector<uint32_t> MeshResiduals::counts() const {
  std::vector<uint32_t> out;
  for (const auto& n : count_) out.push_back(n);
  return out;
}

double MeshResiduals::per_cos2(size_t incidence) const {
  const double share = (double(incidence) + 0.5) / double(kIncidences);
  return std::pow(kLeastCos, -2 * share);
}

std::optional<MeshResiduals::Noise> MeshResiduals::noise(double least_m) const {
  uint64_t all = 0;
  for (const auto& n : count_) all += n;
  if (all < kLeastReturns) return std::nullopt;
  const double width = most_m_ / double(kResiduals);
  const auto log_likelihood = [&](const Parameters& p) {
    const double outliers = 1 / (1 + std::exp(-p[2])), even = outliers / double(kResiduals);
    double sum = 0;
    for (size_t i = 0; i < kIncidences; ++i) {
      const double variance = std::exp(2 * p[0]) + std::exp(2 * p[1]) * per_cos2(i);
      const double scale = width / std::sqrt(2 * variance);
      const double within = std::erf(scale * double(kResiduals));
      double below = 0;
      for (size_t r = 0; r < kResiduals; ++r) {
        const double up_to = std::erf(scale * double(r + 1));
        const uint32_t n = count_[i * kResiduals + r];
        if (n > 0) sum += n * std::log((1 - outliers) * (up_to - below) / within + even);
        below = up_to;
      }
    }
    return sum;
  };
  const double least = std::log(least_m), most_odds = 0;
  const Parameters p = climbed(
      {std::max(std::log(0.02), least), std::log(0.02), -3}, {least, std::log(1e-4), -12},
      [&](const Parameters& at) { return at[2] > most_odds ? -INFINITY : log_likelihood(at); });
  return Noise{std::exp(p[0]), std::exp(p[1])};
}

void set_noise(elements::TriangleMesh& mesh, const MeshResiduals& residuals, double least_m) {
  const auto noise = residuals.noise(least_m);
  if (!noise) return;
  mesh.range_sigma_m = noise->range_sigma_m;
  mesh.roughness_m = noise->roughness_m;
}

}  // namespace underbrush::credit
