/// \file
/// Grass.
#pragma once
#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::test_site {

/// Bent blades on a square patch about the origin, gathered in tussocks.
struct GrassParameters {
  double size_m = 1;      ///< Side of the patch; blades root inside, their tips may lean out.
  double height_m = 0.6;  ///< Mean height of the tips; their standard deviation is 20 % of it.
  double blades_per_m2 = 400;
  double tussocks_per_m2 = 8;  ///< 0 scatters the blades evenly.
  double tussock_radius_m = 0.12;
  double blade_width_m = 0.006;  ///< At the foot.
  double lean = 0.5;             ///< Mean of a tip's offset over its height.
  int segments = 2;              ///< A blade is 2·segments − 1 triangles.
};

/// Short grass after mowing: even, upright, 5 cm.
GrassParameters mowed_grass(double size_m);

/// The mesh at the identity pose. Throws `std::invalid_argument` on impossible sizes.
PlantMesh grass_patch(const GrassParameters& parameters, uint64_t seed);

/// One tussock of `blades` blades about the origin; `parameters` gives their shape.
PlantMesh tussock(const GrassParameters& parameters, int blades, uint64_t seed);

}  // namespace underbrush::test_site
