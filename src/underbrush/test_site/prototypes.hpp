/// \file
/// The prototypes of the plants of the test site.
#pragma once
#include <string>
#include <vector>

#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::test_site {

/// A plant at the identity pose: base at the origin, z up.
struct Prototype {
  std::string name;
  PlantMesh plant;
  double height_m = 0;  ///< m; height of its highest vertex.
  double radius_m = 0;  ///< m; radius of the vertical cylinder about the origin that holds it.
};

/// Range of indices of the prototypes of one kind.
struct PrototypeRange {
  uint32_t begin = 0, end = 0;
};

/// Prototypes: a dozen trees of 4 to 14 m, shrubs of 0.35 to 2.8 m, tussocks of tall grass, and
/// tufts of short grass.
struct PrototypeSet {
  std::vector<Prototype> prototypes;
  PrototypeRange trees, shrubs, tussocks, mowed;
};
/// Makes the prototypes; the same seed gives the same set. A `variation` above 1 changes the
/// species: crown radius and base, trunk, leaf area index and leaf size of each are multiplied by
/// factors drawn from [1 / variation, variation], uniformly in the logarithm. Throws
/// `std::invalid_argument` for a variation outside [1, 2].
PrototypeSet make_prototypes(uint64_t seed, double variation = 1);

}  // namespace underbrush::test_site
