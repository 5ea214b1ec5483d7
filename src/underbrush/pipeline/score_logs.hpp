/// \file
/// The verb `score`: a real log and a simulated one in, scores out.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/metrics/clouds.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::pipeline {

/// The options of `score`.
struct ScoreOptions {
  std::string memory = regions::kMemory;  ///< For a world of regions (`regions::memory_of`).
  std::string protocol;                   ///< "kitti360" or "clouds"; "" = neither.
  bool repeats = false;                   ///< Whether scans from one place are compared.
};

/// The table of these options, of which `memory` is the first.
std::span<const Option<ScoreOptions>> score_options();

/// Compares a simulated log with the real log of the same beams (`metrics::score`). With a world,
/// likelihood, CRPS and calibration under the ray model are computed; the intensities of a world of
/// one model are grouped by its elements. Of a world of regions those regions are opened that the
/// beams can reach, within `memory` (`regions::memory_of`). With `cloud`, the distances of the
/// clouds are computed. `progress(done, total)` may be empty. Throws as `metrics::score` does, and
/// `DataError` where the regions that a beam can reach do not fit into the memory.
metrics::Score score_logs(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                          bool cloud, const std::function<void(size_t, size_t)>& progress = {},
                          const std::string& memory = regions::kMemory);

/// Compares two logs that share no beams as point clouds (`metrics::compare_clouds`), without the
/// beams that met something that was marked as moving.
metrics::CloudScores score_clouds(BeamSource& real, BeamSource& simulated,
                                  const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::pipeline
