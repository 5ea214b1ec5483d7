/// \file
/// Explains the end of a beam in a world: the elements that it meets and their trials.
#pragma once
#include <cstdint>
#include <string>

#include "underbrush/serve/log_data.hpp"
#include "underbrush/serve/world_data.hpp"

namespace underbrush::serve {

/// Follows a logged beam through a world and returns as JSON the elements that it meets, in order
/// of range: for each its range and σ (m), Mahalanobis distance, p, hits and misses, the number
/// drawn for its trial in [0, 1), whether it accepts the beam (the draw is below p), and the
/// probability that a beam reaches it. `simulated_range_m` is the range that `underbrush simulate
/// WORLD --like LOG` gives with that seed and otherwise default options; it is null for a miss.
/// `ends_by` is `element`, `keyframe` (of the model), `unknown space` or `miss`, and `ends_at` is
/// the index of the element, the first one that accepts. `keyframes` is the value of
/// `LogData::keyframes_serve` for the world.
///
/// Objects that move are where they are at the beam's time.
std::string trace_beam(const LoggedBeam& beam, const WorldData& world, uint64_t seed,
                       bool keyframes);

}  // namespace underbrush::serve
