#include "underbrush/perception/size_prior.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::perception {
namespace {

double density(double x, double mean, double sigma) {
  const double u = (x - mean) / sigma;
  return std::exp(-u * u / 2) / (sigma * std::sqrt(2 * M_PI));
}

// The share of the prior above m.
double share_above(double m, const Estimate& prior) {
  return std::erfc((m - prior.mean) / (prior.sigma * std::sqrt(2.0))) / 2;
}

// The normal distribution truncated to L ≥ m. Far in the tail it is exponential.
Estimate truncated(double m, const Estimate& prior) {
  const double a = (m - prior.mean) / prior.sigma;
  if (a > 6) return {m + prior.sigma / a, prior.sigma / a};
  const double hazard = density(a, 0, 1) / share_above(m, prior);
  const double variance = std::max(1 + a * hazard - hazard * hazard, 0.0);
  return {prior.mean + prior.sigma * hazard, prior.sigma * std::sqrt(variance)};
}

// The product of the prior and a measurement, both normal.
Estimate combined(double m, double s, const Estimate& prior) {
  const double wp = 1 / (prior.sigma * prior.sigma), wm = 1 / (s * s);
  return {(prior.mean * wp + m * wm) / (wp + wm), std::sqrt(1 / (wp + wm))};
}

// The densities of m where all of the object is seen, and where a part is hidden.
std::array<double, 2> densities(double m, const Estimate& prior, double s, double hidden) {
  return {(1 - hidden) * density(m, prior.mean, std::hypot(prior.sigma, s)),
          hidden * share_above(m, prior) / prior.mean};
}

}  // namespace

Estimate complete_extent(double m, const Estimate& prior, double s, double hidden) {
  const auto [seen, cut] = densities(m, prior, s, hidden);
  const double all = seen + cut;
  // A measurement far above the range of the prior is kept.
  if (!(all > 1e-12)) return {std::max(m, prior.mean), std::max(s, prior.sigma)};
  const Estimate a = combined(m, s, prior), b = truncated(m, prior);
  const double w = seen / all, mean = w * a.mean + (1 - w) * b.mean;
  const double second =
      w * (a.sigma * a.sigma + a.mean * a.mean) + (1 - w) * (b.sigma * b.sigma + b.mean * b.mean);
  return {mean, std::sqrt(std::max(second - mean * mean, 0.0))};
}

double extent_density(double m, const Estimate& prior, double s, double hidden) {
  const auto [seen, cut] = densities(m, prior, s, hidden);
  return seen + cut;
}

// The side along the length is seen if the viewpoint lies beside the box, and not at a grazing
// angle; the one along the width, if it lies before or behind it.
std::array<bool, 2> visible_sides(const SegmentShape& shape, double least_incidence) {
  const Eigen::Vector2d view = shape.viewpoint_m.head<2>();
  const double distance = std::max(view.norm(), 1e-9);
  const auto beside = [&](int axis) {
    const double outside = std::abs(view[axis]) - shape.box.size_m[axis] / 2;
    return outside > 0 && std::abs(view[axis]) / distance > least_incidence;
  };
  return {beside(1), beside(0)};
}

ObjectClass vehicle_of(const Vec3& size_m) {
  constexpr double kFarthest = 4;  // In standard deviations.
  const CompletionOptions defaults;
  ObjectClass best = ObjectClass::kOther;
  double most = 0;
  for (const auto label :
       {ObjectClass::kCar, ObjectClass::kVan, ObjectClass::kTruck, ObjectClass::kCyclist}) {
    const SizePrior& prior = defaults.priors[size_t(label)];
    const Vec3 off = (size_m - prior.mean_m).cwiseQuotient(prior.sigma_m);
    if (off.cwiseAbs().maxCoeff() > kFarthest) continue;
    const double likelihood = std::exp(-off.squaredNorm() / 2) / prior.sigma_m.prod();
    if (likelihood > most) {
      most = likelihood;
      best = label;
    }
  }
  return best;
}

CompletedBox complete(const SegmentShape& shape, ObjectClass label,
                      const CompletionOptions& options) {
  CompletedBox out{shape.box, Vec3::Constant(options.measured_sigma_m)};
  const SizePrior& prior = options.priors[size_t(label)];
  if (!options.enabled || !prior.is_known()) return out;
  const auto visible = visible_sides(shape, options.least_incidence);
  Vec3 shift = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double measured = shape.box.size_m[axis];
    const bool seen = axis < 2 && visible[size_t(axis)];
    const Estimate e =
        complete_extent(measured, {prior.mean_m[axis], prior.sigma_m[axis]},
                        options.measured_sigma_m, seen ? options.hidden_probability : 1.0);
    out.box.size_m[axis] = e.mean;
    out.sigma_m[axis] = e.sigma;
    double near = std::clamp(shape.viewpoint_m[axis] / std::max(measured / 2, 0.05), -1.0, 1.0);
    // From above, the top is seen, and what is near the ground may have been taken for it.
    if (axis == 2) near = near < 1 ? -1 : 1;
    shift[axis] = -near * (e.mean - measured) / 2;
  }
  out.box.centre_m = shape.box.from_box(shift);
  return out;
}

}  // namespace underbrush::perception
