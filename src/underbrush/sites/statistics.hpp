/// \file
/// Statistics of a site: the density, the distances and the sizes of its plants.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"
#include "underbrush/sites/window.hpp"

namespace underbrush::sites {

/// A statistic of a site; NaN where there is nothing to measure.
struct Statistic {
  std::string name, unit;
  double value = 0;
};

/// Measures the objects that stand in a window, trees and shrubs apart: their density, mean
/// distance to the nearest neighbour and its 10 % quantile, height and width; the correlation of a
/// tree's height with the distance to its nearest tree; the mean distance of a shrub to the nearest
/// tree; the share of the area below boxes of trees, and of all objects, where a box counts as the
/// ellipse in it (a cell of a patch as a square); and the share of patches.
std::vector<Statistic> statistics_of(const Window& window,
                                     std::span<const primitives::PlacedObject> objects);

/// Measures the ground: the root mean square of the difference of heights at some distances, about
/// the mean plane.
std::vector<Statistic> statistics_of(const primitives::GroundSurface& ground);

}  // namespace underbrush::sites
