#include "underbrush/metrics/score_sums.hpp"

#include <algorithm>

#include "underbrush/core/median.hpp"

namespace underbrush::metrics {

Summary Sums::finish() {
  Summary s = counts;
  score_counts(s);
  packets.close();
  if (packets.packets) s.packet_error_m = packets.total / double(packets.packets);
  if (!range_errors.empty()) s.median_range_error_m = median(std::move(range_errors));
  if (s.beams) s.capped_error_m = capped / double(s.beams);
  if (points[0] && points[1]) {
    const double a = double(points[0]), b = double(points[1]);
    s.cloud_error_m = 0.5 * (cloud[0] / a + cloud[1] / b);
    s.density_aware_chamfer = 0.5 * (chamfer[0] / a + chamfer[1] / b);
  }
  if (likelihoods) {
    s.nll_per_beam = nll / double(likelihoods);
    s.crps_m = crps / double(likelihoods);
  }
  return s;
}

}  // namespace underbrush::metrics
