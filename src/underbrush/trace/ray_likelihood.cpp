#include "underbrush/trace/ray_likelihood.hpp"

#include <cmath>

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
