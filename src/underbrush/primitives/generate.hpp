/// \file
/// Annotations of sites that nobody has seen.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// What grows on a generated site.
struct GenerateOptions {
  std::string kind = "forest";  ///< Or "savanna", "meadow": `site_kinds()`.
  double density = 0;           ///< Of the kind's main plants, per m²; 0 = the kind's own.
  uint64_t seed = 1;
  double margin_m = 0;      ///< Nothing stands nearer than this to the ground's border.
  double patch_cell_m = 2;  ///< Side of the cells of patches.
};

/// Names of the kinds.
///
/// | kind | trees per m² | shrubs per m² | patches |
/// |---|---|---|---|
/// | forest | **0.05**, half large | 0.02 | ferns: 10 % of the area |
/// | savanna | **0.003**, small and medium | 0.015 | 5 % |
/// | meadow | 0.0003 | **0.01**, low and small | 50 % |
///
/// The density given replaces the bold figure.
std::vector<std::string> site_kinds();

/// Objects over the ground: trees and shrubs as Poisson points that keep apart by their crowns (a
/// tenth of the crowns' radii may overlap in a forest), patches where a smooth random field is
/// high. Boxes follow height-to-crown relations of the kind. The same for the same seed. Throws
/// `std::invalid_argument` for an unknown kind, or a density that is negative or above 10.
std::vector<PlacedObject> generate_objects(const GroundSurface& ground,
                                           const GenerateOptions& options);

}  // namespace underbrush::primitives
