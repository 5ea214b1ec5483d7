#include "underbrush/osi/osi_options.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::osi {

std::span<const Option<OsiOptions>> osi_options() {
  using O = OsiOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"truth", "", "", "record: the ground truth: objects, as perceive takes them, or learnt actors",
     [](O& o) -> auto& { return o.truth; }, -kNoLimit, kNoLimit, {}, "FILE|DIR"},

    {"chain", "Replay", "", "The strategies and their parameters",
     [](O& o) -> auto& { return o.replay.chain; }, -kNoLimit, kNoLimit, {}, "CHAIN.yaml"},
    {"strategy", "Replay", "",
     "Run this strategy; may be repeated. Without it and without --chain, all run: front_end, "
     "alignment, tracking, classification, grid; without reflections or with --world behind a tracer",
     [](O& o) -> auto& { return o.replay.strategies; }, -kNoLimit, kNoLimit, {},
     "NAME[:KEY=VALUE,...]"},
    {"sensor", "Replay", "", "The sensor of the tracer and the front end",
     [](O& o) -> auto& { return o.replay.sensor; }, -kNoLimit, kNoLimit, {}, "NAME|FILE"},
    {"world", "Replay", "", "The model or scene that the tracer's rays meet",
     [](O& o) -> auto& { return o.replay.world; }, -kNoLimit, kNoLimit, {}, "DIR"},
    {"without-view", "Replay", "",
     "Leave the SensorView out of the SensorData, which makes them small; the tracking model needs "
     "its ground truth",
     [](O& o) -> auto& { return o.without_view; }},

    {"actors", "More options", "",
     "replay: learnt models for the tracer, each where the trace has what it is named after, else for "
     "things of its class",
     [](O& o) -> auto& { return o.replay.actors; }, -kNoLimit, kNoLimit, {}, "DIR"},
    {"white", "More options", "",
     "record, convert: the log's intensity of a white target, for signal strengths",
     [](O& o) -> auto& { return o.lidar.white_intensity; }, kPositive, kNoLimit},
    {"truth-elevation-deg", "More options", "",
     "record: turn labelled boxes up by this angle, as import turned the beams",
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
