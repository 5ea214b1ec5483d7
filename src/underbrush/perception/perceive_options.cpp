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
     "The tracking model, which assigns points by the truth, or a real pipeline",
     [](O& o) -> auto& { return o.pipeline; }, -kNoLimit, kNoLimit, {"model", "real"}},
    {"rig", "", "", "The sensors of the vehicle, for a log of several",
     [](O& o) -> auto& { return o.rig; }, -kNoLimit, kNoLimit, {}, "RIG.yaml"},
    {"min-range", "", "",
     "Ignore hits nearer than this, m, such as those on the own vehicle",
     [](O& o) -> auto& { return o.setup.cycles.min_range_m; }, 0, 1000},
    {"sensor-height", "", "m",
     "Height of the sensor above the ground, on which the vehicle's frame stands; the file of a rig "
     "has the heights of its sensors",
     [](O& o) -> auto& { return o.setup.cycles.sensor_height_m; }, 0, 100},
    {"truth-elevation-deg", "", "",
     "Turn labelled boxes up by this angle, as import turned the beams",
     [](O& o) -> auto& { return o.truth_elevation_deg; }, -90, 90},
    {"no-deskew", "", "", "Ignore the vehicle's motion within a cycle",
     [](O& o) -> auto& { return o.no_deskew; }},

    {"existence", "Existence", "",
     "When an object is listed: by its probability, after --needed cycles in a row with points, or "
     "after --needed of --window cycles",
     [](O& o) -> auto& { return o.existence; }, -kNoLimit, kNoLimit,
     {"probability", "in-a-row", "out-of"}},
    {"gain", "Existence", "", "Probability that a cycle with points adds",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.gain; }, 1e-6, 1},
    {"loss", "Existence", "", "Probability that a cycle without points subtracts",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.loss; }, 1e-6, 1},
    {"threshold", "Existence", "", "Probability from which on an object is listed",
     [](O& o) -> auto& { return o.setup.model.track.existence.threshold; }, 1e-6, 1},
    {"start-points", "Existence", "",
     "An object that is not listed needs more points than this number",
     [](O& o) -> auto& { return o.setup.model.track.existence.step.start_points; }, 0, 1e6},
    {"full-extent", "Existence", "m",
     "Segments that are smaller than this add less; 0 = all add the same",
     [](O& o) -> auto& { return o.setup.model.track.existence.full_extent_m; }, 0, 100},
    {"needed", "Existence", "", "Cycles with points",
     [](O& o) -> auto& { return o.setup.model.track.existence.needed; }, 1, 32},
    {"window", "Existence", "", "Cycles among which they are counted",
     [](O& o) -> auto& { return o.setup.model.track.existence.window; }, 1, 32},
    {"lost", "Existence", "",
     "Cycles without points after which an object is dropped, with --existence in-a-row or out-of",
     [](O& o) -> auto& { return o.setup.model.track.existence.lost; }, 0, 1e5},

    {"reference", "State", "", "The point that is tracked",
     [](O& o) -> auto& { return o.reference; }, -kNoLimit, kNoLimit,
     {"corner", "centre", "gravity"}},
    {"heading", "State", "", "Where the tracking model takes headings from",
     [](O& o) -> auto& { return o.heading; }, -kNoLimit, kNoLimit, {"points", "truth"}},
    {"as-measured", "State", "",
     "Report boxes as the points show them, not completed by the sizes of the class",
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
    {"ghosts-per-s", "State", "", "Objects that do not exist, in each second",
     [](O& o) -> auto& { return o.setup.ghosts.rate_per_s; }, 0, 1000},
    {"ghost-life", "State", "s", "Mean life of such an object",
     [](O& o) -> auto& { return o.setup.ghosts.mean_life_s; }, 1e-3, 1000},

    {"cell", "Grid", "m", "Side of a cell",
     [](O& o) -> auto& { return o.grid.cell_m; }, 0.01, 10},
    {"half-side", "Grid", "m",
     "Distance that the grid reaches from the vehicle along x and y",
     [](O& o) -> auto& { return o.grid.half_side_m; }, 1, 500},
    {"low", "Grid", "m", "Matter counts from this height above the ground on",
     [](O& o) -> auto& { return o.grid.low_m; }, -100, 100},
    {"high", "Grid", "m", "Matter counts up to this height",
     [](O& o) -> auto& { return o.grid.high_m; }, -100, 100},
    {"memory", "Grid", "", "Share of the evidence that stays from cycle to cycle",
     [](O& o) -> auto& { return o.grid.memory; }, 0, 1},
    {"label-probability", "Grid", "",
     "A cell that no state fills with this probability is unknown",
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
