#include "underbrush/perception/perceive_options.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

// long: the table of the options.
std::span<const Option<PerceiveOptions>> perceive_options() {
  using O = PerceiveOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"truth", "", "",
     "The true objects: labelled boxes in the sensor's frame (CSV with frame and track_id), or lists "
     "of objects in the world's frame (CSV, JSON, or an OSI trace)",
     [](O& o) -> auto& { return o.truth; }, -kNoLimit, kNoLimit, {}, "FILE"},
    {"pipeline", "", "",
     "How objects are found: model = the tracking model, which assigns points to true objects; "
     "real = without the truth",
     [](O& o) -> auto& { return o.pipeline; }, -kNoLimit, kNoLimit, {"model", "real"}},
    {"rig", "", "", "File with the sensors of the vehicle, for a log of several sensors",
     [](O& o) -> auto& { return o.rig; }, -kNoLimit, kNoLimit, {}, "RIG.yaml"},
    {"min-range", "", "m",
     "Ignore hits nearer than this; for example those on the own vehicle",
     [](O& o) -> auto& { return o.setup.cycles.min_range_m; }, 0, 1000},
    {"sensor-height", "", "m",
     "Height of the sensor above the ground, on which the vehicle's frame stands; the file of a rig "
     "has the heights of its sensors",
     [](O& o) -> auto& { return o.setup.cycles.sensor_height_m; }, 0, 100},
    {"truth-elevation-deg", "", "", kElevationHelp,
     [](O& o) -> auto& { return o.truth_elevation_deg; }, -90, 90},
    {"no-deskew", "", "", "Ignore the vehicle's motion within a cycle",
     [](O& o) -> auto& { return o.no_deskew; }},

    {"existence", "Existence", "",
     "When an object is listed: probability = when its probability of existence is high enough; "
     "in-a-row = after --needed cycles with points in a row; out-of = after points in --needed of "
     "--window cycles",
     [](O& o) -> auto& { return o.existence; }, -kNoLimit, kNoLimit,
     {"probability", "in-a-row", "out-of"}},
    {"gain", "Existence", "",
     "Increase of an object's existence probability in a cycle in which it has points",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.gain; }, 1e-6, 1},
    {"loss", "Existence", "",
     "Decrease of an object's existence probability in a cycle in which it has no points",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.loss; }, 1e-6, 1},
    {"threshold", "Existence", "", "Least existence probability of a listed object",
     [](O& o) -> auto& { return o.setup.model.track.existence.threshold; }, 1e-6, 1},
    {"start-points", "Existence", "",
     "An object that is not listed needs more points than this number",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.start_points; }, 0, 1e6},
    {"full-extent", "Existence", "m",
     "Full size of a segment; smaller segments raise the existence probability less; 0 = all "
     "segments raise it equally",
     [](O& o) -> auto& { return o.setup.model.track.existence.full_extent_m; }, 0, 100},
    {"needed", "Existence", "", "Number of cycles with points after which an object is listed",
     [](O& o) -> auto& { return o.setup.model.track.existence.needed; }, 1, 32},
    {"window", "Existence", "", "Number of recent cycles among which those with points are counted",
     [](O& o) -> auto& { return o.setup.model.track.existence.window; }, 1, 32},
    {"lost", "Existence", "",
     "Number of cycles in a row without points after which an object is dropped, with --existence "
     "in-a-row or out-of",
     [](O& o) -> auto& { return o.setup.model.track.existence.lost; }, 0, 1e5},

    {"reference", "State", "", "The point that is tracked",
     [](O& o) -> auto& { return o.reference; }, -kNoLimit, kNoLimit,
     {"corner", "centre", "gravity"}},
    {"heading", "State", "", "The source of the tracking model's headings",
     [](O& o) -> auto& { return o.heading; }, -kNoLimit, kNoLimit, {"points", "truth"}},
    {"as-measured", "State", "",
     "Report the boxes of the visible points instead of completing them to the sizes of the class",
     [](O& o) -> auto& { return o.as_measured; }},
    {"ground", "State", "", "Ground removal of the real pipeline",
     [](O& o) -> auto& { return o.ground; }, -kNoLimit, kNoLimit, {"cone", "lower_envelope"}},
    {"latency-ms", "State", "ms", "Time from a cloud to its list",
     [](O& o) -> auto& { return o.latency_ms; }, 0, 1e5},
    {"merge-close", "State", "",
     "Merge objects of the tracking model that are nearer to each other than the sensor resolves",
     [](O& o) -> auto& { return o.setup.model.resolution.enabled; }},
    {"merge-gap", "State", "m", "Distance below which objects are always merged",
     [](O& o) -> auto& { return o.setup.model.resolution.least_gap_m; }, 0, 100},
    {"ghosts-per-s", "State", "", "Mean number of ghost objects that appear per second",
     [](O& o) -> auto& { return o.setup.ghosts.rate_per_s; }, 0, 1000},
    {"ghost-life", "State", "s", "Mean life of a ghost object",
     [](O& o) -> auto& { return o.setup.ghosts.mean_life_s; }, 1e-3, 1000},

    {"cell", "Grid", "m", "Side of a cell",
     [](O& o) -> auto& { return o.grid.cell_m; }, 0.01, 10},
    {"half-side", "Grid", "m",
     "Distance that the grid reaches from the vehicle along x and y",
     [](O& o) -> auto& { return o.grid.half_side_m; }, 1, 500},
    {"low", "Grid", "m", "Lower bound of the heights above the ground that count as obstacles",
     [](O& o) -> auto& { return o.grid.low_m; }, -100, 100},
    {"high", "Grid", "m", "Upper bound of the heights above the ground that count as obstacles",
     [](O& o) -> auto& { return o.grid.high_m; }, -100, 100},
    {"memory", "Grid", "", "Share of the evidence that is kept from cycle to cycle",
     [](O& o) -> auto& { return o.grid.memory; }, 0, 1},
    {"label-probability", "Grid", "",
     "A cell is unknown if no state has at least this probability",
     [](O& o) -> auto& { return o.area.free_probability; }, 0, 1},
  };
// clang-format on
return kOptions;
}

PerceptionSetup setup_of(const PerceiveOptions& o) {
  check_options("perceive", perceive_options(), o);
  PerceptionSetup s = o.setup;
  if (!o.rig.empty()) s.rig = load_rig(o.rig);
  s.is_model = o.pipeline == "model";
  s.cycles.alignment.deskew = !o.no_deskew;
  s.model.track.reference = o.reference == "corner"   ? ReferencePoint::kCorner
                            : o.reference == "centre" ? ReferencePoint::kGeometricCentre
                                                      : ReferencePoint::kCentreOfGravity;
  s.model.track.existence.rule = o.existence == "probability" ? ExistenceRule::kProbability
                                 : o.existence == "in-a-row"  ? ExistenceRule::kInARow
                                                              : ExistenceRule::kOutOf;
  s.model.track.completion.enabled = !o.as_measured;
  s.model.heading = o.heading == "truth" ? HeadingSource::kTruth : HeadingSource::kPoints;
  s.model.latency_s = s.real.latency_s = o.latency_ms / 1000;
  s.real.track = s.model.track;
  s.real.clusters.ground = o.ground;
  return s;
}

}  // namespace underbrush::perception
