/// \file
/// This file measures how well objects that were found agree with true ones.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace underbrush::metrics {

/// The score of objects that are matched one to one. A found and a true object match if they share
/// at least half of the points that either has (IoU ≥ 0.5); above 0.5, at most one match is
/// possible.
struct InstanceScore {
  size_t found = 0, truth = 0, matched = 0;
  double mean_iou = 0;  ///< Mean over the matched objects, 0 without any.

  /// The shares of the found and of the true objects that are matched, and their harmonic mean.
  /// Each is NaN without objects.
  double precision() const;
  double recall() const;
  double f1() const;
};

/// Counts points by found and by true object; 0 is none.
class InstanceCounter {
 public:
  void add(uint32_t found, uint32_t truth) {
    if (found || truth) ++points_[{found, truth}];
  }
  /// Computes the score of the objects with at least `min_points` points. `min_iou` > 0 is the
  /// least IoU of a match.
  InstanceScore score(size_t min_points = 1, double min_iou = 0.5) const;

 private:
  std::map<std::pair<uint32_t, uint32_t>, size_t> points_;
};

}  // namespace underbrush::metrics
