#include "underbrush/fit/beam_shares.hpp"

#include <cmath>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::fit {

void share_out(std::span<const trace::Met> met, double range_m, const Unexplained& unexplained,
               double max_range_m, BeamShares& out) {
  const bool is_hit = range_m != kMiss;
  out.hit.assign(met.size(), 0);
  out.pass.resize(met.size());
  const double kept = 1 - unexplained.hit - unexplained.miss;
  double through = kept, density = 0;
  for (size_t k = 0; k < met.size(); ++k) {
    const trace::Met& m = met[k];
    if (is_hit && m.sigma_m > 0) {
      const double x = (range_m - m.t_m) / m.sigma_m;
      if (std::abs(x) < 12) {
        out.hit[k] = through * m.p * std::exp(-0.5 * x * x) / (std::sqrt(2 * M_PI) * m.sigma_m);
        density += out.hit[k];
      }
    }
    through *= 1 - m.p;
  }
  const double stray = is_hit ? unexplained.hit / max_range_m : unexplained.miss;
  const double total = stray + (is_hit ? density : through);
  out.log_likelihood = std::log(total);
  out.unexplained = stray / total;
  double later = is_hit ? 0 : through / total;
  for (size_t k = met.size(); k-- > 0;) {
    out.hit[k] /= total;
    out.pass[k] = later;
    later += out.hit[k];
  }
}

}  // namespace underbrush::fit
