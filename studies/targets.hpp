/// \file
/// The targets of [deschaud12] §V.A as fine geometry before a standing scanner.
#pragma once
#include <string>
#include <vector>

#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::studies {

/// A target in the world. The scanner stands at the origin of the xy plane, the target some way
/// along +x, and the ground is at z = 0.
struct StaticTarget {
  std::string name;
  test_site::PlantMesh geometry;
  double centre_z_m = 1;       ///< m; height of the middle of the scanned part.
  double half_height_m = 0.5;  ///< m; the target is scanned up to this far above and below it.
  bool porous = true;
};

/// Returns the names of the targets in the order of Table I: `planes`, `tree_high`, `tree_medium`,
/// `tree_low`, `tall_grass`, `short_grass`.
std::vector<std::string> static_target_names();

/// Returns the target of that name, whose middle is `distance_m` from the scanner. `planes` are two
/// boards of 1.2 m width that meet at a right angle in a vertical edge towards the scanner. The
/// trees are 2.8 m high, with a leaf area of 4, 1.5 and 0.5 times the crown's disc. The grass is
/// 0.8 m or 5 cm high, on flat ground. Throws `std::invalid_argument` for another name or a
/// distance below 3 m.
StaticTarget static_target(const std::string& name, double distance_m, uint64_t seed);

}  // namespace underbrush::studies
