#include "underbrush/pipeline/score_logs.hpp"

#include "underbrush/core/still_beams.hpp"

namespace underbrush::pipeline {
namespace {

/// Opens parts of a world of regions for a score.
class Parts {
 public:
  Parts(const TracedWorld& world, uint64_t memory_bytes)
      : world_(world), open_(*world.regions(), memory_bytes) {}

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

std::span<const Option<ScoreOptions>> score_options() {
  using O = ScoreOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"memory", "More options", "", regions::kMemoryHelp,
     [](O& o) -> auto& { return o.memory; }, -kNoLimit, kNoLimit, {}, "SIZE"},
    {"protocol", "More options", "",
     "Other scores: kitti360 adds scores of range images of 66 x 1030 pixels, by which learned "
     "simulators are compared on KITTI-360; clouds compares logs that share no beams as point clouds",
     [](O& o) -> auto& { return o.protocol; }, -kNoLimit, kNoLimit, {"kitti360", "clouds"}},
    {"repeats", "More options", "",
     "Compare the scans that were recorded from one place: the change of ranges from scan to "
     "scan, and the distance of their bearing x range histograms",
     [](O& o) -> auto& { return o.repeats; }},
  };
// clang-format on
return kOptions;
}

metrics::Score score_logs(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                          bool cloud, const std::function<void(size_t, size_t)>& progress,
                          const std::string& memory) {
  metrics::ScoreOptions options;
  options.cloud = cloud;
  if (world) {
    options.world = &world->still();
    if (world->still().is_one_model()) options.model = options.world;
  }
  const uint64_t memory_bytes = regions::memory_of(memory);
  std::optional<Parts> parts;
  if (world && world->regions()) {
    parts.emplace(*world, memory_bytes);
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
