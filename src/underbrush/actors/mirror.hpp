/// \file
/// Completion by symmetry: the shape of a thing on the side that no beam came from.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::actors {

/// Adds the mirror images of ellipsoids of an actor's model, whose plane of symmetry is y = 0, and
/// returns how many there are. An image is added where less than a tenth of as many of `beams` (the
/// actor's frame) met its place as met the ellipsoid itself. It keeps the hit probability and the
/// light of its ellipsoid. The other elements do not change. The origin of the model must be zero.
size_t complete_by_symmetry(const BeamLog& beams, elements::Model& model);

}  // namespace underbrush::actors
