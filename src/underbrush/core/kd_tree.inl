// A k-d tree over points in three dimensions, which shows nanoflann: for sources, never for a
// public header. A module that includes it LINKs nanoflann::nanoflann.
#pragma once
#include <cstdint>
#include <nanoflann.hpp>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush {

/// Points as nanoflann wants them: `coordinate(i, axis)` of `count` points.
template <class Coordinate>
struct KdTreePoints {
  using Scalar = std::invoke_result_t<const Coordinate&, size_t, size_t>;

  size_t count;
  Coordinate coordinate;

  size_t kdtree_get_point_count() const { return count; }
  Scalar kdtree_get_pt(size_t i, size_t axis) const { return coordinate(i, axis); }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// The tree; what `coordinate` refers to must outlive it. Searches may run on any number of
/// threads.
template <class Coordinate>
class KdTree {
 public:
  using Points = KdTreePoints<Coordinate>;
  using Scalar = typename Points::Scalar;

  /// Leaves hold up to `leaf_size` points.
  KdTree(size_t count, Coordinate coordinate, size_t leaf_size)
      : points_{count, std::move(coordinate)},
        tree_(3, points_, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size)) {}
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  /// Fills `index` and `squared_distance` with the up to `k` points nearest to `x` (three numbers),
  /// the nearest first; returns how many there are.
  size_t nearest(const Scalar* x, size_t k, uint32_t* index, Scalar* squared_distance) const {
    return tree_.knnSearch(x, k, index, squared_distance);
  }
  /// The points' numbers, leaf by leaf: near ones after one another.
  const std::vector<uint32_t>& order() const { return tree_.vAcc; }

 private:
  Points points_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<Scalar, Points>, Points, 3,
                                      uint32_t>
      tree_;
};

/// Coordinates of a cloud.
struct CloudCoordinate {
  std::span<const Vec3f> points;
  float operator()(size_t i, size_t axis) const { return points[i][Eigen::Index(axis)]; }
};

/// A k-d tree over a cloud.
class CloudTree : public KdTree<CloudCoordinate> {
 public:
  explicit CloudTree(std::span<const Vec3f> points, size_t leaf_size = 12)
      : KdTree(points.size(), CloudCoordinate{points}, leaf_size) {}
};

}  // namespace underbrush
