/// \file
/// Histograms of the ranges of clouds, for the first comparison of [kim12].
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace underbrush::studies {

/// Counts of ranges in bins of equal width; bin k holds [first + k·bin, first + (k+1)·bin).
struct RangeHistogram {
  double first_m = 0, bin_m = 0.05;
  std::vector<uint64_t> count;

  uint64_t total() const;
  /// Share (0 to 1) of bin k in all ranges.
  double share(size_t k) const { return double(count[k]) / double(total()); }
};

/// Histograms of two clouds over the same bins.
struct RangeHistograms {
  RangeHistogram a, b;
  /// Largest difference of the shares of a bin (0 to 1).
  double largest_difference() const;
  /// Mean difference of the shares of a bin (0 to 1), over the bins that are not empty on both
  /// sides.
  double mean_difference() const;
  /// Mean difference of the counts of a bin, over the same bins.
  double mean_count_difference() const;
};

/// Returns the histograms of two sets of ranges (m) over the bins that hold both, whose bounds are
/// multiples of `bin_m` plus `from_m`. Instruments report ranges in steps. A bound that lies on a
/// step moves the whole step from one bin to the other with any rounding error, so it should lie
/// between two steps. Throws `std::invalid_argument` where a set is empty, a range is not finite or
/// negative, `bin_m` is not positive, `from_m` is not finite or there would be more than 10⁷ bins.
RangeHistograms range_histograms(std::span<const double> a, std::span<const double> b, double bin_m,
                                 double from_m = 0);

}  // namespace underbrush::studies
