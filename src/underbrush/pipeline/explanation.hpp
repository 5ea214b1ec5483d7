/// \file
/// This file explains the end of a simulated beam.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/trace/element_math.hpp"

namespace underbrush::pipeline {

/// An element that a beam meets, with its trial.
struct MetElement {
  trace::Intersection met;
  double draw = 0;       ///< The number in [0, 1) that was drawn for the trial.
  bool accepts = false;  ///< Whether the trial ends the beam: `draw` is less than the element's p.
  double reach = 1;      ///< The probability that a beam reaches the element.
};

/// The cause of the end of a beam.
enum class EndsBy { kMiss, kElement, kKeyframe, kUnknownSpace };

/// The explanation of the end of a beam.
struct Explanation {
  trace::RangeLimits limits;
  std::vector<MetElement> met;  ///< In order of range.
  double miss_probability = 1;  ///< The probability that a beam passes all of them.
  /// The probability that a beam ends in unknown space, without keyframes.
  double unknown_probability = 0;
  EndsBy ends_by = EndsBy::kMiss;
  std::optional<size_t> ends_at;  ///< The first of `met` that accepts, if an element ends the beam.
  float range_m = kMiss;          ///< m; the answer of `Simulation::answer`.
  float offset_m = 0;             ///< m; the part of it that is the channel's range offset.
};

/// Explains the answer of `simulate` with default options and this seed to one beam, a log of one
/// row with the number `number` in its log. `keyframes` as in `SimulateOptions`. Objects that move
/// are where they are at the beam's time.
Explanation explain_beam(const TracedWorld& world, uint64_t seed, bool keyframes, size_t number,
                         const BeamLog& beam);

}  // namespace underbrush::pipeline
