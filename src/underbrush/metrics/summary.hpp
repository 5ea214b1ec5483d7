/// \file
/// The scores of a set of beams, real against simulated.
#pragma once
#include <cstddef>
#include <limits>

namespace underbrush::metrics {

/// The value of a score without data.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The scores of a set of beams. A score that has no data or was not asked for is NaN.
///
/// Where most beams return, a simulator that always answers a hit has nearly the best F1 of hits.
/// Its informedness is 0, and so is its F1 of misses. Both compare the beams that missed with those
/// that hit, so they and the precision of misses are NaN where all real beams of the set have the
/// same outcome, as in a log without misses or in one interval of ranges.
struct Summary {
  size_t beams = 0;
  size_t true_hits = 0, false_hits = 0, false_misses = 0, true_misses = 0;
  /// True misses / all real misses (the specificity): the share of real misses reproduced.
  double recall_of_misses = kUnknown;
  /// True misses / all simulated misses: the share of simulated misses that are real. NaN where
  /// nothing was simulated as a miss.
  double precision_of_misses = kUnknown;
  double f1_of_misses = kUnknown;  ///< 2 true misses / (real misses + simulated misses).
  double informedness = kUnknown;  ///< Recall + recall of misses − 1, in [−1, 1] [youden50].
  double precision = kUnknown;     ///< True hits / all simulated hits, [tallavajhula18] eq. 2.
  double recall = kUnknown;        ///< True hits / all real hits, [tallavajhula18] eq. 3.
  double f1 = kUnknown;            ///< F1 of hits: harmonic mean of precision and recall.
  /// Mean over packets of the mean |y − ŷ| of true hits, [tallavajhula18] eq. 1.
  double packet_error_m = kUnknown;
  double median_range_error_m = kUnknown;  ///< Median |ẑ − z| of true hits.
  /// Mean over all beams of |y − ŷ|, at most 2 m; a false hit or miss counts as 2 m, a true miss as
  /// 0. No choice of which beams hit can flatter it.
  double capped_error_m = kUnknown;
  /// Mean distance to the nearest point of the other cloud, averaged over both directions, in
  /// metres and not squared, [tallavajhula18] eq. 4–5. For a subset of the beams, it is taken from
  /// the subset's points to the whole other cloud.
  double cloud_error_m = kUnknown;
  /// Density-aware Chamfer distance (Wu et al. 2021) in [0, 1] with α = 10/m: ½ Σ over both
  /// directions of the mean of 1 − e^{−α d}/n, where n points share the same nearest point.
  double density_aware_chamfer = kUnknown;
  double nll_per_beam =
      kUnknown;              ///< Mean negative log-likelihood of the real outcome (density 1/m).
  double crps_m = kUnknown;  ///< Mean continuous ranked probability score of the range.
};

/// Computes precision, recall and F1 of hits and of misses, and the informedness, from the counts.
void score_counts(Summary& s);

}  // namespace underbrush::metrics
