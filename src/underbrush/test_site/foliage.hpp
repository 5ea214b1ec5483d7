/// \file
/// Wood and leaves about the skeleton of a plant.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/leaf_angle.hpp"
#include "underbrush/test_site/plant_mesh.hpp"
#include "underbrush/test_site/skeleton.hpp"

namespace underbrush::test_site {

/// Size and orientation of the leaves. Needles are modelled as shoots: narrow kites as large as the
/// end of a twig.
struct Foliage {
  double area_m2 = 40;  ///< m²; one-sided area of all leaves together.
  double leaf_length_m = 0.08;
  double leaf_width_m = 0.055;  ///< m; a leaf is a flat kite of area length·width/2, and lengths
                                ///< vary by ±20 %.
  double petiole_m = 0.02;  ///< m; gap between twig and blade; the stalk itself is not modelled.
  LeafAngle angles = LeafAngle::kSpherical;
};

/// Adds tapering tubes along all branches; each starts on the axis of the branch that bears it.
/// `radii` (m) has one entry for each node.
void add_wood(PlantMesh& plant, const Skeleton& skeleton, const std::vector<double>& radii);

/// Adds leaves along the segments that end in a `leafy` node, spread evenly by length; each is
/// turned by the golden angle from the one before. Their normals follow `angles` exactly and are
/// uniform in azimuth; blades point away from the twig as far as that allows. The areas add up to
/// `area_m2`. Throws `std::invalid_argument` for sizes that are not positive.
void add_leaves(PlantMesh& plant, const Skeleton& skeleton, const std::vector<bool>& leafy,
                const Foliage& foliage, Stream& random);

}  // namespace underbrush::test_site
