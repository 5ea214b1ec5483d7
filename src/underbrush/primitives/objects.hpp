/// \file
/// Finds trees, shrubs and patches of shrubs among the points that are not ground.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
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
  double trunk_m = 1;      ///< m; what stands under a crown and is at most this wide is the tree's
                           ///< foot.
  size_t min_points = 10;  ///< Groups with fewer points are not objects.
  SizeRules sizes;
};

/// An object that was found.
struct FoundObject {
  elements::Class label = elements::Class::kUnknown;
  double height_m = 0;  ///< m; height of its top above the ground.
  double side_m = 0;    ///< m; the longer side of its box seen from above.
  size_t points = 0;
};

/// Collects points, then finds objects among them. Memory grows with the number of columns that
/// hold points, not with the number of points.
///
/// Points are sorted into columns, and in each column into runs without an empty gap, so that a
/// shrub under a crown is separate from the crown. Runs of neighbouring columns that overlap in
/// height are joined in a graph.
///
/// Trees are found by flooding that graph from the top: each run joins the crown of its highest
/// neighbour. Where two crowns meet, they become one if the lower peak rises too little above the
/// saddle or stands too near (a watershed with merging by persistence). Narrow groups in the
/// columns of a crown join it; they are tips, and trunks that the scan's shadows separate from
/// their crowns.
///
/// Runs lower than a tree form connected groups. A narrow group under a crown is the foot of the
/// tree, a group around a crown that reaches to the ground is part of it, and any other group is a
/// shrub or, if it is wide, a patch.
class ObjectFinder {
 public:
  /// Throws `std::invalid_argument` for negative lengths or size limits that do not rise.
  explicit ObjectFinder(const ObjectOptions& options = {});
  ~ObjectFinder();

  /// Adds points that are not ground: x and y (m) in any frame, z (m) above the ground. Points that
  /// are not finite are ignored.
  void add(std::span<const Vec3f> points);
  /// Finds the objects among all points added and numbers them from 1 in order of place.
  void find();

  /// Returns the object of a point that was added, 0 for none. Call `find()` first.
  uint32_t object_of(const Vec3f& point) const;
  /// Returns the objects; object i has the number i + 1.
  const std::vector<FoundObject>& objects() const;
  /// Returns the side (m) of the columns in use.
  double cell_m() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace underbrush::primitives
