#include "underbrush/pipeline/score_logs.hpp"

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

}  // namespace underbrush::pipeline
