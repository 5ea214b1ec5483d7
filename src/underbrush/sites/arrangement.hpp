/// \file
/// The state of a simulation of the point process, in which points move.
#pragma once
#include <span>
#include <vector>

#include "underbrush/sites/pair_process.hpp"

namespace underbrush::sites {

/// The points of a window with an index for those nearby, and the number of pairs in the intervals.
class Arrangement {
 public:
  Arrangement(const Window& window, std::span<const MarkedPoint> points);

  /// Tries to move each point once on average: half of the times to a place anywhere in the window,
  /// else to one a few metres away. Each move is accepted by Metropolis's rule. `wanted` are the
  /// numbers T of pairs.
  void sweep(const PointProcess& process, const PairSteps& wanted, Stream& random);
  /// Returns the numbers of pairs.
  const PairSteps& pairs() const { return pairs_; }
  const std::vector<MarkedPoint>& points() const { return points_; }

 private:
  template <class F>
  void for_each_near(const Eigen::Vector2d& at, const F& f) const;
  void count_pairs(uint32_t point, const Eigen::Vector2d& at, double sign);
  double gain_of_counts(const PointProcess& process, const PairSteps& wanted) const;
  size_t bucket_of(const Eigen::Vector2d& at) const;
  void move(uint32_t point, const Eigen::Vector2d& to);

  const Window& window_;
  std::vector<MarkedPoint> points_;
  PairSteps pairs_, change_;  // `change_` is that of the move that is tried.
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<uint32_t>> buckets_;
};

}  // namespace underbrush::sites
