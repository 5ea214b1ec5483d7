#include "underbrush/pipeline/score_logs.hpp"

#include "underbrush/core/still_beams.hpp"

namespace underbrush::pipeline {
namespace {

/// Opens parts of a world of regions for a score.
class Parts {
 public:
  Parts(const TracedWorld& world, const std::string& memory)
      : world_(world), open_(*world.regions(), regions::memory_of(memory)) {}

  metrics::OpenPart open(const BeamLog& beams, size_t begin, double range_m) {
    const size_t end = open_.open_for(beams, begin, {range_m});
    if (const auto regions = open_.changed()) {
      part_.reset();  // Two parts need not be in memory at a time.
      part_ = open_part(world_, *regions);
    }
    return {&part_->still(), end};
  }

 private:
  const TracedWorld& world_;
  regions::OpenRegions open_;
  std::unique_ptr<TracedWorld> part_;
};

}  // namespace

metrics::Score score_logs(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                          bool cloud, const std::function<void(size_t, size_t)>& progress,
                          const std::string& memory) {
  metrics::ScoreOptions options;
  options.cloud = cloud;
  if (world) {
    options.world = &world->still();
    if (world->still().is_one_model()) options.model = options.world;
  }
  std::optional<Parts> parts;
  if (world && world->regions()) {
    parts.emplace(*world, memory);
    options.open = [&](const BeamLog& beams, size_t begin, double range_m) {
      return parts->open(beams, begin, range_m);
    };
  }
  return metrics::score(real, simulated, options, progress);
}

metrics::CloudScores score_clouds(BeamSource& real, BeamSource& simulated,
                                  const std::function<void(size_t, size_t)>& progress) {
  StillBeams still_real(real), still_simulated(simulated);
  return metrics::compare_clouds(still_real, still_simulated, progress);
}

}  // namespace underbrush::pipeline
