/// \file
/// The regions of a world that beams can reach.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/regions/index.hpp"

namespace underbrush::regions {

/// Returns the places in the index, ascending, of the regions that any of the beams [begin, end) of
/// a log meets up to the range `range_m` (m). A region counts as met up to `spread_m` (m) beside
/// its bounds, which is the distance of a beam's rays from its axis.
std::vector<uint32_t> reached(const Index& index, const BeamLog& beams, size_t begin, size_t end,
                              double range_m, double spread_m);

}  // namespace underbrush::regions
