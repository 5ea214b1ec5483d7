/// \file
/// Meshes of shrubs.
#pragma once
#include "underbrush/test_site/foliage.hpp"

namespace underbrush::test_site {

/// Parameters of a shrub, whose stems rise from one foot into a dome of leaves.
struct ShrubParameters {
  double height_m = 1.2;
  double radius_m = 0.8;
  int stems = 7;
  double stem_radius_m = 0.015;  ///< m; radius of the thickest stem at its foot.
  double twig_spacing_m = 0.13;
  Foliage foliage{4, 0.055, 0.035, 0.01, LeafAngle::kSpherical};
};

/// Returns the parameters of a shrub of typical proportions, with leaf area index `lai` over its
/// disc.
ShrubParameters typical_shrub(double height_m, double lai = 2.5);

/// Returns a shrub at the identity pose. Throws `std::invalid_argument` for sizes that are too
/// small or leaves as long as the shrub is high.
PlantMesh shrub(const ShrubParameters& parameters, uint64_t seed);

}  // namespace underbrush::test_site
