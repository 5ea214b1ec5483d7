#include "underbrush/metrics/score_sums.hpp"

#include <algorithm>

namespace underbrush::metrics {

Summary Sums::finish() {
  Summary s = counts;
  score_counts(s);
  packets.close();
  if (packets.packets) s.packet_error_m = packets.total / double(packets.packets);
  if (!range_errors.empty()) {
    const auto middle = range_errors.begin() + std::ptrdiff_t(range_errors.size() / 2);
    std::nth_element(range_errors.begin(), middle, range_errors.end());
    s.median_range_error_m = *middle;
  }
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
