/// \file
/// Shrubs.
#pragma once
#include "underbrush/test_site/foliage.hpp"

namespace underbrush::test_site {

/// Several stems from one foot into a dome of leaves.
struct ShrubParameters {
  double height_m = 1.2;
  double radius_m = 0.8;
  int stems = 7;
  double stem_radius_m = 0.015;  ///< Of the stem that carries most, at the foot.
  double twig_spacing_m = 0.13;
  Foliage foliage{4, 0.055, 0.035, 0.01, LeafAngle::kSpherical};
};

/// A shrub of typical proportions with leaf area index `lai` over its disc.
ShrubParameters typical_shrub(double height_m, double lai = 2.5);

/// The mesh at the identity pose. Throws `std::invalid_argument` on impossible sizes.
PlantMesh shrub(const ShrubParameters& parameters, uint64_t seed);

}  // namespace underbrush::test_site
