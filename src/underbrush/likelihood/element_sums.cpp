#include "underbrush/likelihood/element_sums.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::likelihood {
namespace {

// Row and column of the entries of a symmetric matrix's upper triangle, in the order in which a
// model stores covariances.
constexpr int kRow[6] = {0, 0, 0, 1, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 2};

constexpr size_t kLocks = 4096;

using Sums = std::array<int64_t, kSumRow>;

double value(const Sums& sums, size_t field) { return FixedSum(sums[field]).value(); }

Mat3 symmetric(const Sums& sums, size_t first) {
  Mat3 m;
  for (int k = 0; k < 6; ++k) {
    m(kRow[k], kColumn[k]) = m(kColumn[k], kRow[k]) = value(sums, first + size_t(k));
  }
  return m;
}

EllipsoidForm form_of(const elements::Ellipsoid& e) {
  const Mat3 root = cholesky(e.covariance_matrix()), w = root.inverse();
  return {{e.mean[0], e.mean[1], e.mean[2]},
          {float(w(0, 0)), float(w(1, 0)), float(w(1, 1)), float(w(2, 0)), float(w(2, 1)),
           float(w(2, 2))},
          float(double(e.density_per_m) * std::sqrt(2 * M_PI)),
          e.hit.p};
}

}  // namespace

void FixedSum::add(double term) { bits_ += std::llrint(std::clamp(term, -1e4, 1e4) * 0x1p26); }

void FixedSum::add_shared(double term) {
  const int64_t bits = std::llrint(std::clamp(term, -1e4, 1e4) * 0x1p26);
  std::atomic_ref<int64_t>(bits_).fetch_add(bits, std::memory_order_relaxed);
}

ModelForms::ModelForms(const elements::Model& model, double min_range_m)
    : model_(model),
      min_range_m_(min_range_m),
      ellipsoids_(model.ellipsoids.size()),
      triangle_p_(model.triangle_count()),
      roughness_variance_(model.triangle_count()) {
  parallel_for(ellipsoids_.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) ellipsoids_[i] = form_of(model.ellipsoids[i]);
  });
  for (size_t i = 0; i < triangle_p_.size(); ++i) {
    const elements::ElementPlace at = model.place(uint32_t(i));
    const double roughness = model.mesh(at.kind).roughness_at(at.index);
    triangle_p_[i] = model.hit(i).p;
    roughness_variance_[i] = float(roughness * roughness);
  }
}

ModelForm ModelForms::view() const {
  const auto square = [](double x) { return float(x * x); };
  const elements::TriangleMesh &ground = model_.ground, &surface = model_.surface;
  return {ellipsoids_.data(),
          triangle_p_.data(),
          roughness_variance_.data(),
          uint32_t(ground.size()),
          uint32_t(model_.triangle_count()),
          {square(ground.range_sigma_m), square(surface.range_sigma_m)},
          square(model_.tau),
          float(model_.leaf_angles.level()),
          float(model_.leaf_angles.slope()),
          float(min_range_m_)};
}

ElementSums::ElementSums(const elements::Model& model)
    : triangles_(model.triangle_count()), ellipsoids_(model.ellipsoids.size()), locks_(kLocks) {}

void ElementSums::add(const EllipsoidColumns& meetings, size_t count, const uint32_t* met,
                      const ShareColumns& shares) {
  static_assert(sizeof(Sums) == kSumRow * sizeof(int64_t));
  if (count == 0) return;
  pass_kernels().add(meetings, count, met, uint32_t(triangles_.size()), shares,
                     {ellipsoids_.front().data(), locks_.data(), uint32_t(kLocks - 1)});
}

void ElementSums::add_triangle(uint32_t element, const TriangleSums& terms) {
  std::array<FixedSum, 4>& sums = triangles_[element];
  sums[0].add_shared(terms.hits);
  sums[1].add_shared(terms.passes);
  if (terms.hits == 0) return;
  sums[2].add_shared(terms.roughness_slope);
  sums[3].add_shared(terms.roughness_curvature);
}

void ElementSums::add_noise(elements::Kind mesh, const MeshNoise& noise) {
  MeshNoise& to = noise_[mesh != elements::Kind::kGround];
  for (size_t k = 0; k < to.size(); ++k) to[k].add(noise[k]);
}

void ElementSums::multiply(unsigned factor) {
  if (factor == 1) return;
  for (auto& sums : triangles_) {
    for (FixedSum& sum : sums) sum.multiply(factor);
  }
  for (Sums& sums : ellipsoids_) {
    for (int64_t& sum : sums) sum *= factor;
  }
  for (MeshNoise& sums : noise_) {
    for (FixedSum& sum : sums) sum.multiply(factor);
  }
}

TriangleSums ElementSums::triangle(size_t element) const {
  const std::array<FixedSum, 4>& sums = triangles_[element];
  return {sums[0].value(), sums[1].value(), sums[2].value(), sums[3].value()};
}

EllipsoidSums ElementSums::ellipsoid(size_t index) const {
  const Sums& sums = ellipsoids_[index];
  EllipsoidSums out;
  out.hits = value(sums, kHits);
  out.passes = value(sums, kPasses);
  out.density_slope = value(sums, kDensitySlope);
  out.density_curvature = value(sums, kDensityCurvature);
  for (int k = 0; k < 3; ++k) out.shift_slope[k] = value(sums, kShiftSlope + size_t(k));
  out.shift_curvature = symmetric(sums, kShiftCurvature);
  out.stretch_slope = symmetric(sums, kStretchSlope);
  out.stretch_curvature = symmetric(sums, kStretchCurvature);
  out.along = symmetric(sums, kAlong);
  return out;
}

NoiseSums ElementSums::noise(elements::Kind mesh) const {
  const MeshNoise& sums = noise_[mesh != elements::Kind::kGround];
  return {sums[0].value(), sums[1].value()};
}

}  // namespace underbrush::likelihood
