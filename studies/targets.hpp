/// \file
/// The targets of [deschaud12] §V.A as fine geometry before a standing scanner.
#pragma once
#include <string>
#include <vector>

#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::studies {

/// A target in the world: the scanner stands at the origin of the xy plane, the target some way
/// along +x, the ground at z = 0.
struct StaticTarget {
  std::string name;
  test_site::PlantMesh geometry;
  double centre_z_m = 1;       ///< Height of the middle of what is scanned.
  double half_height_m = 0.5;  ///< Scanned to this far above and below it.
  bool porous = true;
};

/// Names, in the order of Table I: `planes`, `tree_high`, `tree_medium`, `tree_low`, `tall_grass`,
/// `short_grass`.
std::vector<std::string> static_target_names();

/// The target of that name, its middle `distance_m` from the scanner. `planes`: two boards of 1.2 m
/// width that meet at a right angle in a vertical edge towards the scanner. Trees of 2.8 m with a
/// leaf area of 4, 1.5 and 0.5 times the crown's disc. Grass of 0.8 m and 5 cm on flat ground.
/// Throws `std::invalid_argument` for another name or a distance below 3 m.
StaticTarget static_target(const std::string& name, double distance_m, uint64_t seed);

}  // namespace underbrush::studies
