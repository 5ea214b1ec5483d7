/// \file
/// Adaptation of a primitive to the object that it stands for.
#pragma once
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// Whether a primitive can be adapted to an object: the layers of the points of both are known.
bool can_adapt(const PrimitiveEntry& from, const PlacedObject& to);

/// Returns the elements `model` of the primitive `from`, adapted to the object `to` and in its
/// frame.
///
/// Elements move so that they lie as the object's points do. The corners of the box and the heights
/// of the layers (`PointLayers`) become those of the object, and in each layer so do the places
/// along x and y; places between them move in proportion. An ellipsoid is stretched along each axis
/// by the square root of the factor by which its surroundings are, which is kept in [1/4, 4].
///
/// The optical depth of the ellipsoids in each third of the height is multiplied by f^¾, where f is
/// the number of beams that returned from that third of the object, over that expected from the
/// primitive along the same paths: f = (n + 40 f₀) / (ρ L + 40) with the object's n returns and
/// path L (`BoxBeams`), the primitive's returns per metre ρ, and f₀ = (n + 40) / (ρ L + 40) of the
/// sums over the thirds; f is kept in [1/5, 5]. The exponent is below 1 because returns per metre
/// also depend on where the beams cross the box. The factor is 1 where the beams of the object or
/// of the primitive are not known.
elements::Model adapted(elements::Model model, const PrimitiveEntry& from, const PlacedObject& to);

}  // namespace underbrush::primitives
