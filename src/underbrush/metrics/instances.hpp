/// \file
/// How well objects that were found agree with true ones.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace underbrush::metrics {

/// Objects matched one to one: a found and a true object are the same if they share at least half
/// of the points that either has (IoU ≥ 0.5; above 0.5 the match is unique by itself).
struct InstanceScore {
  size_t found = 0, truth = 0, matched = 0;
  double mean_iou = 0;  ///< Of the matched ones, 0 without any.

  /// Shares of the found and of the true ones that are matched, NaN where there are none.
  double precision() const;
  double recall() const;
  double f1() const;
};

/// Counts points by found and true object; 0 is none.
class InstanceCounter {
 public:
  void add(uint32_t found, uint32_t truth) {
    if (found || truth) ++points_[{found, truth}];
  }
  /// Of the objects with at least `min_points` points. `min_iou` must exceed 0.
  InstanceScore score(size_t min_points = 1, double min_iou = 0.5) const;

 private:
  std::map<std::pair<uint32_t, uint32_t>, size_t> points_;
};

}  // namespace underbrush::metrics
