/// \file
/// Finds trees, shrubs and patches of shrubs among the points that are not ground.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/primitives/object_options.hpp"

namespace underbrush::primitives {

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
