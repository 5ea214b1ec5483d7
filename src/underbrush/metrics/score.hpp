/// \file
/// This file scores how realistic a simulation of a log's beams is.
#pragma once
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/metrics/intensity.hpp"
#include "underbrush/metrics/reliability.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::metrics {

/// The value of a score without data.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The scores of a set of beams. A score that has no data or was not asked for is NaN.
struct Summary {
  size_t beams = 0;
  size_t true_hits = 0, false_hits = 0, false_misses = 0, true_misses = 0;
  double precision = kUnknown;  ///< True hits / all simulated hits, [tallavajhula18] eq. 2.
  double recall = kUnknown;     ///< True hits / all real hits, [tallavajhula18] eq. 3.
  double f1 = kUnknown;         ///< Harmonic mean of precision and recall.
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

/// Counts of ẑ − z in bins of equal width. The first and the last bin are open.
struct RangeErrorHistogram {
  static constexpr double kHalfWidth = 2.0, kBin = 0.05;  // m
  std::vector<size_t> count = std::vector<size_t>(size_t(2 * kHalfWidth / kBin + 0.5) + 2);
  void add(double error_m);
};

/// The scores of a simulation.
struct Score {
  Summary all;
  bool cloud = false, likelihood = false;  ///< Which scores were asked for.
  /// Scores by the real log's column `class`. The key is the class's name in the log's label set,
  /// or its number as text.
  std::map<std::string, Summary> per_class;
  std::map<std::string, Summary> per_range;  ///< Scores by real range ("0-10", … m, "miss").
  RangeErrorHistogram range_error;
  Reliability reliability;  ///< The model's probability of a return; empty without a model.
  /// Roughness along the rings (`RingRoughness::median`, m) of the simulated and of the real log;
  /// NaN for logs without rings.
  double roughness_m = kUnknown, real_roughness_m = kUnknown;
  /// Scores of intensities; without them, `no_intensity` says why.
  std::optional<IntensityScore> intensity;
  std::string no_intensity;
  size_t mover_beams = 0;  ///< Left out: the real return has the flag `kMover`.
};

/// The options of `score`.
struct ScoreOptions {
  bool cloud = true;  ///< Whether to compute cloud error and density-aware Chamfer distance.
  /// If not null, likelihood and CRPS under the ray model are computed.
  const trace::World* world = nullptr;
  /// If not null, the world of one model, by whose elements intensities are told apart.
  const trace::World* model = nullptr;
  std::vector<double> range_edges_m = {0, 10, 20, 30, 50, 80};
};

/// Compares a simulated log with the real log of the same beams. Where the world's model has range
/// offsets of the sensor that recorded the real log (`Model::channels_of`), they are taken away
/// from both logs. `progress(done, total)` may be empty. Throws `std::invalid_argument` where the
/// beams differ in number, scan, ring or origin.
Score score(BeamSource& real, BeamSource& simulated, const ScoreOptions& options,
            const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::metrics
