/// \file
/// Trees, shrubs and patches of shrubs among the points that are not ground.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/primitives/size_rules.hpp"

namespace underbrush::primitives {

/// Parameters of `ObjectFinder`. Lengths that grow with a crown are given as a + b · height.
struct ObjectOptions {
  double cell_m = 0;  ///< Side of a column; 0 = by the points' density, 0.4 to 1 m.
  /// Empty height that parts what stands in one column; 0 = by the columns' side: 1 m, or 12 m
  /// where they are wider than 0.5 m (a scan from above, which shows little below the tops).
  double gap_m = 0;
  double spacing_a_m = 1.2;  ///< Peaks nearer together than a + b · height are one crown ...
  double spacing_b = 0.06;
  double prominence_a_m = 0.3;  ///< ... and so are those parted by a dip less deep than this
  double prominence_b = 0.04;   ///< (half of it where columns are wider than 0.5 m), ...
  double radius_a_m = 1.5;      ///< ... unless a crown would reach farther than this from its peak.
  double radius_b = 0.3;
  double trunk_m = 1;      ///< Width up to which what stands under a crown is its foot.
  size_t min_points = 10;  ///< Fewer are no object.
  SizeRules sizes;
};

/// An object found.
struct FoundObject {
  elements::Class label = elements::Class::kUnknown;
  double height_m = 0;  ///< Of its top above the ground.
  double side_m = 0;    ///< The longer side of its box seen from above.
  size_t points = 0;
};

/// Gathers points, then finds objects in them: memory grows with the columns that hold points, not
/// with the points.
///
/// Points are sorted into columns, and in each column into runs without an empty gap, so that a
/// shrub under a crown is not the crown. Runs of neighbouring columns that overlap in height are
/// joined in a graph. Trees are found by flooding that graph from the top: each run joins the crown
/// of its highest neighbour, and where two crowns meet they become one if the lower peak rises too
/// little above the saddle or stands too near (a watershed with merging by persistence). Narrow
/// groups that stand in a crown's columns join it: trunks parted from their crowns by the scan's
/// shadows, tips. What is lower than a tree becomes connected groups: a narrow one under a crown is
/// the tree's foot, one that hems a crown reaching to the ground is part of it, any other is a
/// shrub or, if it extends, a patch.
class ObjectFinder {
 public:
  /// Throws `std::invalid_argument` for lengths that are not positive.
  explicit ObjectFinder(const ObjectOptions& options = {});
  ~ObjectFinder();

  /// Adds points that are not ground: x and y (m) in any frame, z (m) above the ground. Points that
  /// are not finite are passed over.
  void add(std::span<const Vec3f> points);
  /// Finds the objects of all points added. Numbers are given from 1 in the order of place.
  void find();

  /// The object of a point that was added, 0 for none. After `find()`.
  uint32_t object_of(const Vec3f& point) const;
  /// Object i has number i + 1.
  const std::vector<FoundObject>& objects() const;
  /// Side of the columns that was used.
  double cell_m() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace underbrush::primitives
