/// \file
/// Leaving primitives of given plants out of a set, so that a scene has none of the plants that it
/// is compared with.
#pragma once
#include <span>

#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::primitives {

/// Whether two objects stand on common ground: their boxes overlap as seen from above.
bool share_ground(const PlacedObject& a, const PlacedObject& b);

/// Takes those primitives out of a set that were cut from an object that shares ground with one of
/// `objects`, and returns how many these are. The set and the objects must be of one world frame.
/// Primitives made of meshes were cut from no object, so they stay. Throws `FormatError` where the
/// file of a primitive is damaged.
size_t leave_out(PrimitiveSet& set, std::span<const PlacedObject> objects);

}  // namespace underbrush::primitives
