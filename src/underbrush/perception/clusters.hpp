/// \file
/// This file finds the clusters of points above the ground in a merged cloud, without ground truth.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "underbrush/perception/cloud.hpp"
#include "underbrush/perception/segments.hpp"

namespace underbrush::perception {

/// The options of `Clusters`.
struct ClusterOptions {
  /// "cone" is a quick method of its own; "lower_envelope" is `ground::lower_envelope`, which is
  /// better on rough terrain, but takes longer and allocates memory.
  std::string ground = "cone";
  double reach_m = 100;        ///< m; points farther away, along x or y, are left out.
  double ground_cell_m = 0.8;  ///< m; side of a cell of the ground.
  double slope = 0.15;         ///< Steepest ground.
  double clearance_m = 0.3;    ///< m; points less than this above the ground belong to it.
  double highest_m = 3.5;      ///< m; points higher above the ground are left out.
  double cell_m = 0.25;        ///< m; side of a cell of the clustering.
  double gap_m = 0.5;          ///< m; points nearer to each other than this are one cluster.
  double gap_rad = 0.012;      ///< The distance grows by this with the range.
  size_t least_points = 4;     ///< A cluster with fewer points is left out.
  double largest_m = 13;       ///< m; a cluster of a larger extent is part of a building.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// Separates the points above the ground from the ground, and divides them into clusters.
///
/// Ground, "cone": the second lowest point of each cell gives its height, and the ground is the
/// lower envelope of the cones of the given slope that stand on these heights, found by two passes
/// over the cells. Heights that lie far below those around them are left out, because reflections
/// show points below the ground. Clusters: points are entered in square cells, and cells with
/// points whose distance is at most the gap at their range are connected.
class Clusters {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit Clusters(const ClusterOptions& options = {});
  /// Fills `segments` with the clusters, in order of their first point. `world` has the cloud's
  /// points in the world's frame, which the segments are in.
  void find(const MergedCloud& cloud, std::span<const Vec3> world, Segments& segments);
  /// Whether each point of the last cloud is ground.
  std::span<const uint8_t> ground() const { return ground_; }

 private:
  size_t cell_of(const Vec3f& p, double side_m, size_t columns) const;
  void find_ground(const MergedCloud& cloud);
  void remove_pits();
  void spread_heights();
  void enter(const MergedCloud& cloud);
  void connect(const MergedCloud& cloud);
  uint32_t root(uint32_t cell);
  void number(const MergedCloud& cloud, std::span<const Vec3> world, Segments& segments);

  ClusterOptions options_;
  size_t ground_columns_, columns_;
  std::vector<float> height_, second_, around_;
  std::vector<uint8_t> ground_;
  std::vector<uint32_t> entry_;     ///< Entry of each cell of the plane, or none.
  std::vector<uint32_t> cell_;      ///< Cell of each entry.
  std::vector<uint32_t> parent_;    ///< The parent of each entry.
  std::vector<uint32_t> of_point_;  ///< Entry of each point.
  std::vector<uint32_t> count_, number_;
  std::vector<Vec3f> low_, high_;  ///< Extents of each cluster.
};

}  // namespace underbrush::perception
