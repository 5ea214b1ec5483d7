/// \file
/// The support of the answers to beams: the share that rests on space that a log observed.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// The extra column with the support of each beam.
inline constexpr const char* kSupportColumn = "support";

/// Computes the support of each beam of a log in a world (`trace::support_of`); 1 where the world
/// has no unknown space.
std::vector<float> supports(const trace::World& world, const BeamLog& beams);

}  // namespace underbrush::simulate
