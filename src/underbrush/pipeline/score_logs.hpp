/// \file
/// The verb `score`: a real log and simulated ones in, scores out.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/metrics/baselines.hpp"
#include "underbrush/metrics/clouds.hpp"
#include "underbrush/metrics/range_image.hpp"
#include "underbrush/metrics/repeats.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::pipeline {

/// The options of `score`.
struct ScoreOptions {
  std::string memory = regions::kMemory;  ///< For a world of regions (`regions::memory_of`).
  std::string protocol{};                 ///< "kitti360" or "clouds"; "" = neither.
  bool repeats = false;                   ///< Whether scans from one place are compared.
  bool cloud = true;                      ///< Whether point clouds are compared; not in the table.
};

/// The table of these options.
std::span<const Option<ScoreOptions>> score_options();

/// A simulated log, which has the beams of the real one.
struct SimulatedLog {
  std::string name;  ///< In the results.
  std::string file;  ///< Its name in errors; empty where it is no file.
  metrics::OpenLog log;
  /// Opens the world that it was simulated in; may be empty.
  std::function<std::shared_ptr<const TracedWorld>()> world;
};

/// What `score` compares. `train`, the log that the models were fitted to, may be empty.
struct ScoreInput {
  metrics::OpenLog real, train;
  std::vector<SimulatedLog> simulated;
};

/// The scores of a simulated log or of a baseline. Protocols that were not asked for are empty.
struct LogScore {
  std::string name;
  metrics::Score score;
  std::optional<metrics::ProtocolScores> kitti360;
  std::optional<metrics::Repeats> repeats;
};

/// What `score` returns.
struct Scores {
  std::vector<LogScore> simulated, baselines;
};

/// Receives the name of the log that is compared, and how many of its beams are done.
using ScoreProgress = std::function<void(const std::string& name, size_t done, size_t total)>;

/// Compares simulated logs and the baselines (`metrics::answer_by_baselines`) with the real log of
/// the same beams: each by `score_log`, and by the protocols of the options. The clouds of *always
/// hit* are not compared. Throws as `score_log` does, with the file of the simulated log, and
/// `std::invalid_argument` for the protocol "clouds", which `score_clouds` is for.
Scores score_logs(const ScoreInput& input, const ScoreOptions& options,
                  const ScoreProgress& progress = {});

/// Compares a simulated log with the real log of the same beams (`metrics::score`). With a world,
/// likelihood, CRPS and calibration under the ray model are computed; the intensities of a world of
/// one model are grouped by its elements. Of a world of regions those regions are opened that the
/// beams can reach, within `options.memory`. Throws as `metrics::score` does, and `DataError` where
/// the regions that a beam can reach do not fit into the memory.
metrics::Score score_log(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                         const ScoreOptions& options = {},
                         const std::function<void(size_t, size_t)>& progress = {});

/// Compares two logs that share no beams as point clouds (`metrics::compare_clouds`), without the
/// beams that met something that was marked as moving.
metrics::CloudScores score_clouds(BeamSource& real, BeamSource& simulated,
                                  const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::pipeline
