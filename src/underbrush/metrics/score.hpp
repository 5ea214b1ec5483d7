/// \file
/// This file scores how realistic a simulation of a log's beams is.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/metrics/intensity.hpp"
#include "underbrush/metrics/reliability.hpp"
#include "underbrush/metrics/summary.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::metrics {

/// Counts of ẑ − z in bins of equal width. The first and the last bin are open.
struct RangeErrorHistogram {
  static constexpr double kHalfWidth = 2.0, kBin = 0.05;  // m
  std::vector<size_t> count = std::vector<size_t>(size_t(2 * kHalfWidth / kBin + 0.5) + 2);
  void add(double error_m);
};

/// The scores of a simulation.
struct Score {
  Summary all;
  bool cloud = false, likelihood = false;  ///< Whether these scores were requested.
  /// Scores by the real log's column `class`. The key is the class's name in the log's label set,
  /// or its number as text.
  std::map<std::string, Summary> per_class;
  std::map<std::string, Summary> per_range;  ///< Scores by real range ("0-10", … m, "miss").
  /// Scores by the share of a beam's outcome that rests on observed space (`trace::support_of`):
  /// "observed" (at least 0.9), "partly" and "unknown" (below 0.5). Empty for a model without a map
  /// of observed space.
  std::map<std::string, Summary> per_support;
  RangeErrorHistogram range_error;
  Reliability reliability;  ///< The model's probability of a return; empty without a model.
  /// Roughness along the rings (`RingRoughness::median`, m) of the simulated and of the real log;
  /// NaN for logs without rings.
  double roughness_m = kUnknown, real_roughness_m = kUnknown;
  /// Scores of intensities; where they are absent, `no_intensity` has the reason.
  std::optional<IntensityScore> intensity;
  std::string no_intensity;
  size_t mover_beams = 0;  ///< Beams left out because their real return has the flag `kMover`.
};

/// The part of a world larger than memory that serves some beams.
struct OpenPart {
  const trace::World* world;  ///< Valid until the next part is opened.
  size_t end;                 ///< The first beam of the log that it does not serve.
};

/// The options of `score`.
struct ScoreOptions {
  bool cloud = true;  ///< Whether to compute cloud error and density-aware Chamfer distance.
  /// If not null, likelihood and CRPS under the ray model are computed.
  const trace::World* world = nullptr;
  /// For a world larger than memory, whose common data `world` and `model` have: a function that
  /// opens the part that the beams of a log from `begin` on reach up to a range (m).
  std::function<OpenPart(const BeamLog& beams, size_t begin, double range_m)> open;
  /// If not null, the world of one model, by whose elements intensities are grouped.
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
