/// \file
/// Meshes of trees.
#pragma once
#include "underbrush/test_site/foliage.hpp"

namespace underbrush::test_site {

/// The two growth forms of trees.
enum class Species : uint8_t {
  kBroadleaf,  ///< Limbs at the golden angle, and twigs by space colonisation of a lumpy crown.
  kConifer,    ///< One straight stem with whorls of drooping branches.
};

/// Parameters of a tree. Lengths are those of the whole plant with its leaves, to within a few per
/// cent.
struct TreeParameters {
  Species species = Species::kBroadleaf;
  double height_m = 9;
  double crown_radius_m = 2.2;
  double crown_base_m = 2;       ///< m; height of the lowest branches.
  double trunk_radius_m = 0.13;  ///< m; at the foot, above the flare of the roots.
  double twig_spacing_m = 0.3;   ///< m; distance between neighbouring twigs, which determines the
                                 ///< fineness of the tree.
  Foliage foliage;
};

/// Returns the parameters of a tree of typical proportions: crown, trunk and leaf area (leaf area
/// index `lai` over the crown's disc) follow from its height; leaves are 8 cm long, shoots 11 × 3
/// cm.
TreeParameters typical_tree(Species species, double height_m, double lai = 3);

/// Returns a tree at the identity pose. Throws `std::invalid_argument` for sizes that are too
/// small, or a crown that does not begin between ground and top.
PlantMesh tree(const TreeParameters& parameters, uint64_t seed);

/// Returns the branches of a tree, without wood and leaves.
Skeleton tree_skeleton(const TreeParameters& parameters, Stream& random);

}  // namespace underbrush::test_site
