/// \file
/// This file lists the elements that the beams of a log may meet.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/likelihood/beam_block.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::likelihood {

/// Lists the elements that the beams of a block may meet in a world of one model: all triangles up
/// to a beam's reach, and all ellipsoids that may take credit for its outcome. The list also has a
/// few ellipsoids that single precision cannot distinguish from these. `info` is the log's.
void find_meetings(const trace::World& world, const LogInfo& info, BeamBlock& block);

}  // namespace underbrush::likelihood
