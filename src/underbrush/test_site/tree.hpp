/// \file
/// Trees.
#pragma once
#include "underbrush/test_site/foliage.hpp"

namespace underbrush::test_site {

/// The two habits of growth.
enum class Species : uint8_t {
  kBroadleaf,  ///< Limbs at the golden angle, twigs by space colonisation of a lumpy crown.
  kConifer,    ///< One straight stem with whorls of drooping branches.
};

/// Lengths are those of the whole plant, leaves included, to within a few per cent.
struct TreeParameters {
  Species species = Species::kBroadleaf;
  double height_m = 9;
  double crown_radius_m = 2.2;
  double crown_base_m = 2;       ///< Height of the lowest branches.
  double trunk_radius_m = 0.13;  ///< At the foot, above the flare of the roots.
  double twig_spacing_m = 0.3;   ///< Distance between neighbouring twigs: how finely it branches.
  Foliage foliage;
};

/// A tree of typical proportions: crown, trunk and leaf area (leaf area index `lai` over the
/// crown's disc) from its height; leaves of 8 cm, or shoots of 11 × 3 cm.
TreeParameters typical_tree(Species species, double height_m, double lai = 3);

/// The mesh at the identity pose. Throws `std::invalid_argument` on impossible sizes.
PlantMesh tree(const TreeParameters& parameters, uint64_t seed);

/// The branches alone.
Skeleton tree_skeleton(const TreeParameters& parameters, Stream& random);

}  // namespace underbrush::test_site
