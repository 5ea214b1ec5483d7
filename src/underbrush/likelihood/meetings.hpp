/// \file
/// This file lists which elements the beams of a log may meet.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/likelihood/beam_block.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::likelihood {

/// Lists what the beams of a block may meet in a world of one model. Those are all triangles up to
/// a beam's reach, and all ellipsoids that may give credit for its outcome, with a few more that
/// single precision does not tell from these. `info` is the log's.
void find_meetings(const trace::World& world, const LogInfo& info, BeamBlock& block);

}  // namespace underbrush::likelihood
