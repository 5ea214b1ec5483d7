#include "underbrush/metrics/summary.hpp"

namespace underbrush::metrics {

void score_counts(Summary& s) {
  const double hits = double(s.true_hits), misses = double(s.true_misses);
  const double real_hits = double(s.true_hits + s.false_misses);
  const double simulated_hits = double(s.true_hits + s.false_hits);
  const double real_misses = double(s.true_misses + s.false_hits);
  const double simulated_misses = double(s.true_misses + s.false_misses);
  if (simulated_hits > 0) s.precision = hits / simulated_hits;
  if (real_hits > 0) s.recall = hits / real_hits;
  if (s.precision + s.recall > 0) s.f1 = 2 * s.precision * s.recall / (s.precision + s.recall);
  if (real_misses > 0) s.recall_of_misses = misses / real_misses;
  if (real_misses == 0 || real_hits == 0) return;
  if (simulated_misses > 0) s.precision_of_misses = misses / simulated_misses;
  s.f1_of_misses = 2 * misses / (real_misses + simulated_misses);
  s.informedness = s.recall + s.recall_of_misses - 1;
}

}  // namespace underbrush::metrics
