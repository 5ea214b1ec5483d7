/// \file
/// The ground below the elements that an update has fitted anew.
#pragma once
#include <vector>

#include "underbrush/core/tile_store.hpp"
#include "underbrush/credit/crossing_beams.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::update {

/// Returns the area in which beams may meet refitted elements: the tiles `anew` (of which there is
/// at least one) of a side in metres, and the ellipsoids whose number in the model as it was
/// (`before`) is `fit::kNewEllipsoid`.
credit::GroundArea refitted_area(const elements::Model& model, const std::vector<uint32_t>& before,
                                 const std::vector<TileKey>& anew, double tile_m);

}  // namespace underbrush::update
