/// \file
/// Meshes of grass.
#pragma once
#include "underbrush/test_site/plant_mesh.hpp"

namespace underbrush::test_site {

/// Parameters of bent blades on a square patch about the origin, gathered in tussocks.
struct GrassParameters {
  double size_m = 1;      ///< m; side of the patch. Blades root inside; their tips may lean out.
  double height_m = 0.6;  ///< m; mean height of the tips, whose standard deviation is 20 % of it.
  double blades_per_m2 = 400;
  double tussocks_per_m2 = 8;  ///< 0 scatters the blades evenly.
  double tussock_radius_m = 0.12;
  double blade_width_m = 0.006;  ///< m; at the foot.
  double lean = 0.5;             ///< Mean ratio of a tip's horizontal offset to its height.
  int segments = 2;              ///< A blade has 2·segments − 1 triangles.
};

/// Returns the parameters of grass after mowing: even, upright, 5 cm high.
GrassParameters mowed_grass(double size_m);

/// Returns a patch of grass at the identity pose. Throws `std::invalid_argument` for sizes that are
/// not positive and densities that are negative.
PlantMesh grass_patch(const GrassParameters& parameters, uint64_t seed);

/// Returns a tussock of `blades` blades about the origin, shaped by `parameters`. Throws as
/// `grass_patch` does, and for a tussock without blades.
PlantMesh tussock(const GrassParameters& parameters, int blades, uint64_t seed);

}  // namespace underbrush::test_site
