/// \file
/// The pieces of a site, each at one place: a plant, or a piece of a patch of shrubs.
#pragma once
#include <span>
#include <vector>

#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::sites {

/// A plant, or the cells of a patch of shrubs within a square of 12 m.
struct Piece {
  elements::Class label = elements::Class::kUnknown;  ///< The class of most of its cells.
  Eigen::Vector2d at = Eigen::Vector2d::Zero();       ///< m, world; the mean of its parts' places.
  double radius_m = 0;  ///< A plant: a quarter of length and width. Else the radius of the disc of
                        ///< the same area.
  /// Its objects. Their positions (m) are relative to `at` along x and y; z is not used.
  std::vector<primitives::PlacedObject> parts;
  bool is_cells = false;  ///< Whether the parts are cells of a patch.
};

/// Sorts the objects of a site into pieces, in the order of their first parts. Objects of a patch
/// class that are as long and as wide as `cell_m` (m) are cells.
std::vector<Piece> pieces_of(std::span<const primitives::PlacedObject> objects, double cell_m);

/// Returns the objects of a piece (m, world; z = 0) that stands at `at` and is turned by
/// `turn_rad`; cells are turned by the nearest multiple of 90° and stand on the grid of cells,
/// which goes through the world's origin.
std::vector<primitives::PlacedObject> objects_of(const Piece& piece, const Eigen::Vector2d& at,
                                                 double turn_rad, double cell_m);

}  // namespace underbrush::sites
