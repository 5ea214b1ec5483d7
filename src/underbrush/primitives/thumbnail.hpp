/// \file
/// Pictures of primitives.
#pragma once
#include "underbrush/io/image.hpp"
#include "underbrush/primitives/extract.hpp"

namespace underbrush::primitives {

/// Draws the primitive from the side (y towards the viewer), with its foot in the middle of the
/// lower edge and `metres` from top to bottom. Ellipsoids are filled to 1.5 σ, as opaque as they
/// are likely to stop a beam, and coloured by height; triangles are filled.
io::Image thumbnail(const Primitive& primitive, int pixels, double metres);

}  // namespace underbrush::primitives
