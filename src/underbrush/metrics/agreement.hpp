/// \file
/// This file measures how well yes-or-no answers agree with labels.
#pragma once
#include <cstddef>
#include <limits>

namespace underbrush::metrics {

/// Counts of points by the found and by the true answer.
struct Agreement {
  size_t true_positive = 0, false_positive = 0, false_negative = 0, true_negative = 0;

  void add(bool found, bool truth) {
    ++(found ? (truth ? true_positive : false_positive) : (truth ? false_negative : true_negative));
  }
  /// The scores. Each is NaN where no point can be scored.
  double precision() const { return share(true_positive, true_positive + false_positive); }
  double recall() const { return share(true_positive, true_positive + false_negative); }
  /// The intersection over union.
  double iou() const {
    return share(true_positive, true_positive + false_positive + false_negative);
  }

 private:
  static double share(size_t part, size_t whole) {
    return whole ? double(part) / double(whole) : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace underbrush::metrics
