/// \file
/// The ground below what an update has fitted anew.
#pragma once
#include <vector>

#include "underbrush/core/tile_store.hpp"
#include "underbrush/credit/crossing_beams.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::update {

/// Returns where beams may meet what was fitted anew: the tiles `anew` (of which there is at least
/// one) of a side in metres, and the ellipsoids whose number in the model as it was (`before`) is
/// `fit::kNewEllipsoid`.
credit::GroundArea refitted_area(const elements::Model& model, const std::vector<uint32_t>& before,
                                 const std::vector<TileKey>& anew, double tile_m);

}  // namespace underbrush::update
