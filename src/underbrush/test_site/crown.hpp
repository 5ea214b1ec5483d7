/// \file
/// The space that a tree crown fills.
#pragma once
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {

/// An egg-shaped crown about the z axis: half-ellipses above and below its widest height.
struct Crown {
  double base_m = 0;    ///< m; height of its lowest point.
  double top_m = 1;     ///< m; height of its highest point.
  double radius_m = 1;  ///< m; at the widest height.
  double widest = 0.4;  ///< Widest height, as a fraction of the way from base to top.
  double bare = 0.3;    ///< Fraction of the radius, about the axis, in which shade keeps branches
                        ///< thin.

  /// Returns the radius (m) at height `z_m`, 0 outside the crown.
  double radius_at(double z_m) const;
};

/// Returns markers of free space in the crown (m), about `spacing_m` apart. They form lumps a third
/// of the crown's size with gaps between them, as light shapes crowns.
std::vector<Vec3> crown_markers(const Crown& crown, double spacing_m, Stream& random);

}  // namespace underbrush::test_site
