#include "underbrush/perception/classification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

constexpr double kLeastDensity = 1e-6;  // Of a single feature: nothing is impossible.

double log_of(double density) { return std::log(std::max(density, kLeastDensity)); }

}  // namespace

void ClassificationOptions::check() const {
  double sum = 0;
  for (const double p : prior) {
    require(p >= 0, "classification: a prior must not be negative");
    sum += p;
  }
  require(sum > 0 && prior[0] == 0, "classification: a class needs a prior, and unknown has none");
  require(half_points >= 0 && memory >= 0 && memory < 1 && least_probability >= 0,
          "classification: half_points >= 0 and 0 <= memory < 1 must hold");
  require(other_extent_m.minCoeff() > 0, "classification: extents must be positive");
}

Classification::Classification(const ClassificationOptions& options, const CompletionOptions& sizes)
    : options_(options), sizes_(sizes) {
  options_.check();
}

// The two horizontal extents have no order: a class may have either as its length.
double Classification::log_density(ObjectClass label, const SegmentShape& shape,
                                   double speed) const {
  const double scale = std::max(options_.speed_m_s[size_t(label)], 1e-3);
  double sum =
      log_of(2 / (scale * std::sqrt(2 * M_PI)) * std::exp(-speed * speed / (2 * scale * scale)));
  const Vec3& m = shape.box.size_m;
  const SizePrior& prior = sizes_.priors[size_t(label)];
  if (!prior.is_known()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double mean = options_.other_extent_m[axis];
      sum += log_of(std::exp(-m[axis] / mean) / mean);
    }
    return sum;
  }
  const auto visible = visible_sides(shape, sizes_.least_incidence);
  const auto density = [&](int measured, int axis) {
    const double hidden =
        measured < 2 && visible[size_t(measured)] ? sizes_.hidden_probability : 1.0;
    return extent_density(m[measured], {prior.mean_m[axis], prior.sigma_m[axis]},
                          sizes_.measured_sigma_m, hidden);
  };
  const double plain = density(0, 0) * density(1, 1), turned = density(0, 1) * density(1, 0);
  return sum + log_of((plain + turned) / 2) + log_of(density(2, 2));
}

void Classification::observe(const SegmentShape& shape, double speed_m_s,
                             ClassEvidence& evidence) const {
  const double n = double(shape.points), weight = n / (n + options_.half_points);
  for (size_t c = 1; c < kClassCount; ++c) {
    double& sum = evidence.log_likelihood[c];
    sum = options_.memory * sum + weight * log_density(ObjectClass(c), shape, speed_m_s);
  }
}

std::array<float, kClassCount> Classification::probabilities(const ClassEvidence& evidence) const {
  std::array<double, kClassCount> score{};
  double most = -std::numeric_limits<double>::infinity(), sum = 0;
  for (size_t c = 1; c < kClassCount; ++c) {
    if (options_.prior[c] > 0) most = std::max(most, evidence.log_likelihood[c]);
  }
  for (size_t c = 1; c < kClassCount; ++c) {
    score[c] = options_.prior[c] * std::exp(evidence.log_likelihood[c] - most);
    sum += score[c];
  }
  std::array<float, kClassCount> out{};
  for (size_t c = 1; c < kClassCount; ++c) out[c] = float(score[c] / sum);
  return out;
}

ObjectClass Classification::decide(const std::array<float, kClassCount>& probabilities) const {
  const auto best = std::max_element(probabilities.begin(), probabilities.end());
  if (double(*best) < options_.least_probability) return ObjectClass::kUnknown;
  return ObjectClass(best - probabilities.begin());
}

}  // namespace underbrush::perception
