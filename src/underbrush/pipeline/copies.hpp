/// \file
/// Returns that a recording holds twice, as in the dual mode of a sensor where the strongest return
/// is the last one.
#pragma once
#include <cstddef>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// The share of a scan's points that are copies of another one: of the same place, time and ring,
/// to the bit. 0 for scans without times, with misses, or with numbers of returns, which
/// distinguish pulses.
double share_of_copies(const PointScan& scan);

/// Removes all but the first of each such points. Returns how many.
size_t remove_copies(PointScan& scan);

}  // namespace underbrush::pipeline
