/// \file
/// Wood and leaves about a skeleton.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/leaf_angle.hpp"
#include "underbrush/test_site/plant_mesh.hpp"
#include "underbrush/test_site/skeleton.hpp"

namespace underbrush::test_site {

/// What the leaves are like. Needles come as shoots: narrow kites of the size of a twig's end.
struct Foliage {
  double area_m2 = 40;  ///< One-sided area of all leaves together.
  double leaf_length_m = 0.08;
  double leaf_width_m = 0.055;  ///< A leaf is a flat kite of area length·width/2, ±20 % in length.
  double petiole_m = 0.02;      ///< Gap between twig and blade; the stalk itself is not modelled.
  LeafAngle angles = LeafAngle::kSpherical;
};

/// Tapering tubes along all branches; each starts on the axis of the branch that bears it.
/// `radii` (m) has one entry a node.
void add_wood(PlantMesh& plant, const Skeleton& skeleton, const std::vector<double>& radii);

/// Leaves along the segments that end in a node with `leafy`, evenly by length, turned by the
/// golden angle from one to the next. Normals follow `angles` exactly and are uniform in azimuth;
/// blades point away from the twig as far as that allows. The areas add up to `area_m2`.
void add_leaves(PlantMesh& plant, const Skeleton& skeleton, const std::vector<bool>& leafy,
                const Foliage& foliage, Stream& random);

}  // namespace underbrush::test_site
