/// \file
/// The space that a crown fills.
#pragma once
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::test_site {

/// An egg about the z axis: half-ellipses above and below its widest height.
struct Crown {
  double base_m = 0;  ///< Height of its lowest point.
  double top_m = 1;
  double radius_m = 1;  ///< At the widest height.
  double widest = 0.4;  ///< Fraction of the way from base to top.
  double bare = 0.3;    ///< Fraction of the radius, about the axis, that shade keeps thin.

  /// Radius (m) at height `z_m`, 0 outside.
  double radius_at(double z_m) const;
};

/// Markers of free space in the crown, about `spacing_m` apart, in lumps a third of its size with
/// gaps between them, as the light shapes them.
std::vector<Vec3> crown_markers(const Crown& crown, double spacing_m, Stream& random);

}  // namespace underbrush::test_site
