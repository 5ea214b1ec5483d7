#include "underbrush/fit/responsibilities.hpp"

#include <cmath>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::fit {

void find_responsibilities(std::span<const trace::Intersection> met, double range_m,
                           const trace::OutlierShares& outliers, double max_range_m,
                           Responsibilities& out) {
  const bool is_hit = range_m != kMiss;
  trace::mix_ranges(met, outliers.explained(), 0, out.mixture);
  out.hit.resize(met.size());
  out.pass.resize(met.size());
  double density = 0;
  for (size_t k = 0; k < met.size(); ++k) {
    out.hit[k] = is_hit ? out.mixture.components[k].density(range_m) : 0;
    density += out.hit[k];
  }
  const double stray = outliers.likelihood(is_hit, max_range_m);
  const double total = stray + (is_hit ? density : out.mixture.miss);
  out.log_likelihood = std::log(total);
  out.unexplained = stray / total;
  double later = is_hit ? 0 : out.mixture.miss / total;
  for (size_t k = met.size(); k-- > 0;) {
    out.hit[k] /= total;
    out.pass[k] = later;
    later += out.hit[k];
  }
}

}  // namespace underbrush::fit
