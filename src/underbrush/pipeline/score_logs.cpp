#include "underbrush/pipeline/score_logs.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/core/range_unit.hpp"
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

/// Compares the logs by the protocols of the options.
void add_protocols(BeamSource& real, BeamSource& simulated, const ScoreOptions& options,
                   LogScore& out) {
  if (options.protocol == "kitti360") out.kitti360 = metrics::range_image_scores(real, simulated);
  if (options.repeats) out.repeats = metrics::repeats(real, simulated);
}

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

metrics::Score score_log(BeamSource& real, BeamSource& simulated, const TracedWorld* world,
                         const ScoreOptions& options,
                         const std::function<void(size_t, size_t)>& progress) {
  require_metres(real, "score");
  metrics::ScoreOptions scored;
  scored.cloud = options.cloud;
  if (world) {
    scored.world = &world->still();
    if (world->still().is_one_model()) scored.model = scored.world;
  }
  const uint64_t memory_bytes = regions::memory_of(options.memory);
  std::optional<Parts> parts;
  if (world && world->regions()) {
    parts.emplace(*world, memory_bytes);
    scored.open = [&](const BeamLog& beams, size_t begin, double range_m) {
      return parts->open(beams, begin, range_m);
    };
  }
  return metrics::score(real, simulated, scored, progress);
}

Scores score_logs(const ScoreInput& input, const ScoreOptions& options,
                  const ScoreProgress& progress) {
  check_options("score", score_options(), options);
  require(options.protocol != "clouds",
          "score: clouds are compared by compare_clouds, or score --protocol clouds");
  Scores out;
  for (const SimulatedLog& s : input.simulated) {
    const auto real = input.real(), log = s.log();
    auto world = s.world ? s.world() : nullptr;
    std::function<void(size_t, size_t)> told;
    if (progress) told = std::bind_front(progress, s.name);
    LogScore score{s.name, {}, {}, {}};
    try {
      score.score = score_log(*real, *log, world.get(), options, told);
      world.reset();  // The protocols need memory of their own.
      add_protocols(*real, *log, options, score);
    } catch (const DataError& e) {
      if (s.file.empty()) throw;
      throw FormatError(s.file, "", e.what());
    }
    out.simulated.push_back(std::move(score));
  }
  metrics::answer_by_baselines(
      input.real, input.train,
      [&](const std::string& name, BeamSource& real, BeamSource& answered) {
        ScoreOptions own = options;
        own.cloud = options.cloud && name != metrics::kAlwaysHit;
        out.baselines.push_back({name, score_log(real, answered, nullptr, own), {}, {}});
        add_protocols(real, answered, options, out.baselines.back());
      });
  return out;
}

metrics::CloudScores score_clouds(BeamSource& real, BeamSource& simulated,
                                  const std::function<void(size_t, size_t)>& progress) {
  for (BeamSource* log : {&real, &simulated}) require_metres(*log, "score");
  StillBeams still_real(real), still_simulated(simulated);
  return metrics::compare_clouds(still_real, still_simulated, progress);
}

}  // namespace underbrush::pipeline
