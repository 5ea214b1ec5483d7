/// \file
/// The elements of a model that explain the returns of a log.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::credit {

/// Finds the element that explains the range of each hit best (`credit` with the rule "best"), by
/// its number in the model. It is `trace::Intersection::kNone` for a miss and for a hit that no
/// element explains. `world` must be that of one model; `log` is in the world frame.
std::vector<uint32_t> explaining_elements(const trace::World& world, const BeamLog& log);

}  // namespace underbrush::credit
