#include "underbrush/trace/ray_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::trace {

double RangeMixture::Component::density(double range_m) const {
  if (!(sigma_m > 0)) return 0;
  const double x = (range_m - t_m) / sigma_m;
  if (!(std::abs(x) < 12)) return 0;
  return weight * std::exp(-0.5 * x * x) / (std::sqrt(2 * M_PI) * sigma_m);
}

double RangeMixture::likelihood(double range_m) const {
  if (range_m == kMiss) return miss;
  double sum = 0;
  for (const Component& c : components) sum += c.density(range_m);
  return sum;
}

double RangeMixture::returns() const {
  double sum = 0;
  for (const Component& c : components) sum += c.weight;
  return sum;
}

std::optional<double> RangeMixture::median() const {
  const double half = 0.5 * returns();
  if (!(half >= 0.25)) return {};
  // Newton's method, from the component in which half of the weight is reached, between bounds.
  std::vector<std::pair<double, double>> order;
  for (const Component& c : components) order.emplace_back(c.t_m, c.weight);
  std::sort(order.begin(), order.end());
  size_t k = 0;
  for (double sum = order[0].second; sum < half && k + 1 < order.size();) sum += order[++k].second;
  constexpr double kExactM = 0.0005, kLongestM = 1;
  constexpr int kMostSteps = 1000;  // of damaged models with ranges beyond all bounds
  double at = order[k].first, low = -HUGE_VAL, high = HUGE_VAL;
  for (int step = 0; step < kMostSteps && high - low > kExactM; ++step) {
    double over = -half, density = 0;
    for (const Component& c : components) {
      const double off = at - c.t_m;
      if (std::abs(off) >= 6 * c.sigma_m) {
        over += off >= 0 ? c.weight : 0;
      } else {
        over += 0.5 * c.weight * std::erfc(-off / (std::sqrt(2) * c.sigma_m));
        density += c.density(at);
      }
    }
    if (over == 0) break;
    (over < 0 ? low : high) = at;
    const double newton = density > 0 ? std::clamp(-over / density, -kLongestM, kLongestM)
                                      : (over < 0 ? kLongestM : -kLongestM);
    if (std::abs(newton) < kExactM) return at + newton;
    const double next = at + newton;
    at = next > low && next < high ? next : 0.5 * (low + high);
  }
  return at;
}

size_t RangeMixture::likeliest_at(double range_m) const {
  size_t best = 0, nearest = 0;
  double most = 0;
  for (size_t k = 0; k < components.size(); ++k) {
    const double density = components[k].density(range_m);
    if (density > most) most = density, best = k;
    const auto off = [&](size_t c) { return std::abs(range_m - components[c].t_m); };
    if (off(k) < off(nearest)) nearest = k;
  }
  return most > 0 ? best : nearest;
}

void mix_ranges(std::span<const Intersection> met, double weight, double negligible,
                RangeMixture& out) {
  out.components.clear();
  out.miss = weight;
  for (const Intersection& m : met) {
    out.components.push_back({out.miss * m.p, m.t_m, m.sigma_m});
    out.miss *= 1 - m.p;
    if (out.miss < negligible) break;
  }
}

}  // namespace underbrush::trace
