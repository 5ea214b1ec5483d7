/// \file
/// The options of the search for objects.
#pragma once
#include <cstddef>

#include "underbrush/primitives/size_rules.hpp"

namespace underbrush::primitives {

/// Options of `ObjectFinder`. Lengths that grow with a crown are given as a + b · height (m).
struct ObjectOptions {
  double cell_m = 0;  ///< m; side of a column; 0 = by the density of the points, 0.4 to 1 m.
  /// Empty height (m) that separates objects in one column; 0 = by the columns' side: 1 m, or 12 m
  /// where they are wider than 0.5 m (a scan from above, which shows little below the tops).
  double gap_m = 0;
  double spacing_a_m = 1.2;  ///< m; peaks nearer to each other than a + b · height are one crown.
  double spacing_b = 0.06;
  /// Peaks separated by a dip less deep than a + b · height (m) are one crown, too. Half of that
  /// depth counts where columns are wider than 0.5 m.
  double prominence_a_m = 0.3;
  double prominence_b = 0.04;
  double radius_a_m = 1.5;  ///< m; no crown reaches farther than a + b · height from its peak.
  double radius_b = 0.3;
  double trunk_m = 1;      ///< m; a group under a crown that is at most this wide is the tree's
                           ///< foot.
  size_t min_points = 10;  ///< Groups with fewer points are not objects.
  SizeRules sizes;
};

}  // namespace underbrush::primitives
