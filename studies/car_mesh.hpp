/// \file
/// Meshes of road users.
#pragma once
#include "underbrush/elements/model.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::studies {

/// Returns a model of a road user with the origin in the centre of its box and x forwards. A car
/// has a body and a cabin, a van or truck is a block, and of a cyclist or pedestrian only the
/// middle half of the width is filled. All stand 0.2 m above the bottom of the box.
elements::Model road_user(perception::ObjectClass label, const Vec3& size_m);

}  // namespace underbrush::studies
