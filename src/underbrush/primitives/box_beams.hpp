/// \file
/// The beams of a log in the boxes of its objects.
#pragma once
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Measures `PlacedObject::beams` of objects that were measured in the log, which has the columns
/// `class` and `instance`. A beam counts in a box up to where it ends, and as a return there if it
/// ends at the box's own object; so returns / path estimates the density of returns (1/m) of matter
/// in which beams end at random, whatever stands before and behind it. A beam without a return
/// counts up to the maximum range. Where the log has no misses, objects stay as they are. Reads the
/// log once. The result does not depend on the number of threads.
void measure_beams(BeamSource& labelled, std::vector<PlacedObject>& objects);

}  // namespace underbrush::primitives
