#include "underbrush/osi/osi_options.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/perception/perceive_options.hpp"

namespace underbrush::osi {

std::span<const Option<OsiOptions>> osi_options() {
  using O = OsiOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"truth", "", "",
     "record: the true objects, in a file as perceive takes it or as a folder of learnt actors",
     [](O& o) -> auto& { return o.truth; }, -kNoLimit, kNoLimit, {}, "FILE|DIR"},

    {"chain", "Replay", "", "File with the strategies and their parameters",
     [](O& o) -> auto& { return o.replay.chain; }, -kNoLimit, kNoLimit, {}, "CHAIN.yaml"},
    {"strategy", "Replay", "",
     "Run this strategy; may be repeated. Without it and --chain, all run: front_end, alignment, "
     "tracking, classification, grid. A tracer runs before them if the trace has no reflections or "
     "--world is given",
     [](O& o) -> auto& { return o.replay.strategies; }, -kNoLimit, kNoLimit, {},
     "NAME[:KEY=VALUE,...]"},
    {"sensor", "Replay", "", "The sensor of the tracer and the front end",
     [](O& o) -> auto& { return o.replay.sensor; }, -kNoLimit, kNoLimit, {}, "NAME|FILE"},
    {"world", "Replay", "", "The model or scene that the tracer's rays meet",
     [](O& o) -> auto& { return o.replay.world; }, -kNoLimit, kNoLimit, {}, "DIR"},
    {"without-view", "Replay", "",
     "Leave the SensorView out of the SensorData, so that the output is small; the tracking model "
     "needs the ground truth of the SensorView",
     [](O& o) -> auto& { return o.without_view; }},

    {"actors", "More options", "",
     "replay: folder of learnt actors for the tracer. An object of the trace gets the actor of its "
     "name, or else one of its class",
     [](O& o) -> auto& { return o.replay.actors; }, -kNoLimit, kNoLimit, {}, "DIR"},
    {"white", "More options", "",
     "record, convert: intensity of a white target in the log, from which signal strengths are "
     "computed",
     [](O& o) -> auto& { return o.lidar.white_intensity; }, kPositive, kNoLimit},
    {"truth-elevation-deg", "More options", "", perception::kElevationHelp,
     [](O& o) -> auto& { return o.truth_elevation_deg; }, -90, 90},
  };
// clang-format on
return kOptions;
}

void OsiOptions::check(const std::string& action) const {
  check_options("osi", osi_options(), *this);
  require(action == "replay" ||
              (replay.chain.empty() && replay.strategies.empty() && !without_view &&
               replay.sensor.empty() && replay.world.empty() && replay.actors.empty()),
          "osi: --chain, --strategy, --sensor, --world, --actors and --without-view are of replay");
  require(action == "record" || truth.empty(), "osi: --truth is of record");
}

}  // namespace underbrush::osi
