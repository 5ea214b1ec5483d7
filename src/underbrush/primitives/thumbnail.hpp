/// \file
/// A primitive as a picture.
#pragma once
#include "underbrush/io/image.hpp"
#include "underbrush/primitives/extract.hpp"

namespace underbrush::primitives {

/// The primitive from the side (y towards the eye), its foot in the middle of the lower edge,
/// `metres` from top to bottom. Ellipsoids are filled to 1.5 σ, as opaque as they are likely to
/// stop a beam, coloured by height; triangles are drawn as their outlines' fill.
io::Image thumbnail(const Primitive& primitive, int pixels, double metres);

}  // namespace underbrush::primitives
