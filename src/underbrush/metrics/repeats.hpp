/// \file
/// Compares scans that repeat their directions from one place, as [deschaud12] §V.A did.
#pragma once
#include <map>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/metrics/bearing_range.hpp"

namespace underbrush::metrics {

/// The comparison of a simulation with repeated scans of the same place. A figure without data is
/// NaN.
struct Repeats {
  size_t scans = 0;
  size_t directions = 0;  ///< Pairs of beams of one direction in successive scans, all scans.
  /// Median |Δ range| (m) of the beams of one direction in successive scans that both hit, as
  /// measured and as simulated.
  double real_difference_m = NAN, difference_m = NAN;
  /// The difference of scans half a log apart. Scans that repeat have the difference of successive
  /// ones; where it is several times as large the sensor or the world has moved.
  double real_far_difference_m = NAN, far_difference_m = NAN;
  /// Bhattacharyya distance between the bearing × range histograms of the measured even scans and
  /// the simulated odd ones, and the other way round; the mean of both.
  double distance = NAN;
  /// The distance between the measured even and odd scans, scan against scan. It has as many beams
  /// on both sides as `distance`, so a perfect simulator would reach it.
  double floor = NAN;
  /// The distance between measured and simulated beams of the same scans, which a sensor that moves
  /// does not blur.
  double same_scans = NAN;

  /// Whether the scans repeat: far ones differ at most twice as much as successive ones.
  bool repeat() const { return real_far_difference_m <= 2 * real_difference_m; }
};

/// Sizes of the bins: a direction is a ring and a bearing in the sensor's frame at its scan.
struct RepeatOptions {
  BearingRangeBins bins{0.2 * M_PI / 180, 0.05};
};

/// Collects scans one by one.
class RepeatedScans {
 public:
  explicit RepeatedScans(const RepeatOptions& options = {});

  /// Adds a scan of both logs, beam by beam. Unless empty, `chosen` marks the beams that count.
  void add(const BeamLog& real, const BeamLog& simulated, const std::vector<bool>& chosen = {});
  Repeats finish() const;

 private:
  /// The range of the first beam of each direction of a scan.
  using Ranges = std::map<uint32_t, float>;
  static double median_difference(const std::vector<Ranges>& scans, size_t apart, size_t* pairs);

  RepeatOptions options_;
  BearingRangeHistogram histogram_[2][2];  ///< Even and odd scans, measured and simulated.
  std::vector<Ranges> ranges_[2];          ///< By scan, measured and simulated.
};

/// Compares two logs of the same beams. Throws as `for_each_scan` does.
Repeats repeats(BeamSource& real, BeamSource& simulated, const RepeatOptions& options = {});

}  // namespace underbrush::metrics
