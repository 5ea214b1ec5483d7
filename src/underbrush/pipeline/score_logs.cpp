#include "underbrush/pipeline/score_logs.hpp"

#include "underbrush/core/still_beams.hpp"

namespace underbrush::pipeline {

metrics::Score score_logs(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                          bool cloud, const std::function<void(size_t, size_t)>& progress) {
  metrics::ScoreOptions options;
  options.cloud = cloud;
  if (world) {
    options.world = &world->still();
    if (world->still().is_one_model()) options.model = options.world;
  }
  return metrics::score(real, simulated, options, progress);
}

metrics::CloudScores score_clouds(BeamSource& real, BeamSource& simulated,
                                  const std::function<void(size_t, size_t)>& progress) {
  StillBeams still_real(real), still_simulated(simulated);
  return metrics::compare_clouds(still_real, still_simulated, progress);
}

}  // namespace underbrush::pipeline
