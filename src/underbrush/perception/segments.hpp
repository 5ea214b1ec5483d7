/// \file
/// This file has segments: the parts of a cloud that belong to one object each.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// Index of a point that belongs to no segment.
inline constexpr uint32_t kNoSegment = UINT32_MAX;

/// The points of a cloud in the order of their segments.
struct Segments {
  std::vector<uint32_t> of_point;  ///< Segment of each point, or `kNoSegment`.
  std::vector<uint32_t> begin;     ///< Begin of each segment in `point_m`, and the end.
  std::vector<Vec3> point_m;       ///< The points of the segments, in the world's frame.

  /// Number of segments.
  size_t size() const { return begin.empty() ? 0 : begin.size() - 1; }
  std::span<const Vec3> points(size_t segment) const {
    return std::span(point_m).subspan(begin[segment], begin[segment + 1] - begin[segment]);
  }
  /// Sorts the points by `of_point`, in their order, into `count` segments.
  void gather(std::span<const Vec3> points, size_t count);
};

/// The options of `BoxAssignment`.
struct BoxAssignmentOptions {
  double margin_m = 0.1;  ///< A point may lie this far outside the box, but not below it.
  /// Points less than this above the bottom of the box belong to the ground that it stands on.
  double above_bottom_m = 0.1;
};

/// Assigns points to the boxes of the ground truth, [rosenberger20] §3.3: the segments are free of
/// errors.
class BoxAssignment {
 public:
  explicit BoxAssignment(const BoxAssignmentOptions& options = {}) : options_(options) {}
  /// Fills `segments.of_point` with the object of each point, as its index. Of several boxes that
  /// hold a point it takes the one in which the point lies deepest, relative to the box's size, and
  /// of equals the first.
  void assign(std::span<const Vec3> points, std::span<const TruthObject> objects,
              Segments& segments);

 private:
  /// A box prepared for the test of many points.
  struct Prepared {
    double x, y, z, cos, sin, half_length, half_width, low, high;
  };
  void prepare(std::span<const TruthObject> objects);
  void sort_into_cells();

  BoxAssignmentOptions options_;
  std::vector<Prepared> boxes_;
  double origin_x_ = 0, origin_y_ = 0;
  int columns_ = 0, rows_ = 0;
  std::vector<uint32_t> cell_begin_, cell_box_;
};

}  // namespace underbrush::perception
