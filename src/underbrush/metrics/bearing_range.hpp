/// \file
/// What a standing lidar measures as histograms of bearing × range, one a laser, and how much two
/// of them overlap ([deschaud12] §VI.A).
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// Steps of the bins; the defaults are the encoder and the range count of the HDL-64E.
struct BearingRangeBins {
  double bearing_rad = 2 * M_PI / 4000;
  double range_m = 0.002;
};

/// Counts of beams by (laser, bearing, range), beams without a return in a range bin of their own.
/// Memory: the occupied bins, and one chunk of beams at a time.
class BearingRangeHistogram {
 public:
  /// An occupied bin. The bearing is that of `bearing · step`, counter-clockwise from the sensor's
  /// x axis, and half a step to each side; the range is [range, range + 1) steps.
  struct Bin {
    uint16_t ring = 0;
    uint16_t bearing = 0;
    uint32_t range = kNoReturn;
    uint32_t count = 0;
  };
  static constexpr uint32_t kNoReturn = 0xffffffffu;

  /// Throws `std::invalid_argument` where a step is not positive or a turn has more than 2¹⁶
  /// bearings.
  explicit BearingRangeHistogram(const BearingRangeBins& bins = {},
                                 const Pose& world_from_sensor = {});

  /// Adds the beams, by their reported direction and range.
  void add(const BeamLog& beams);

  const BearingRangeBins& bins() const { return bins_; }
  /// In order of ring, bearing and range; the no-return bin comes last.
  const std::vector<Bin>& occupied() const { return occupied_; }
  uint64_t total() const { return total_; }

 private:
  BearingRangeBins bins_;
  Pose sensor_from_world_;
  std::vector<Bin> occupied_;
  uint64_t total_ = 0;
};

/// Σ √(p q) over all bins, p and q the counts over their sums: 1 for equal histograms, 0 for those
/// that share no bin. Where both hold as many beams in every direction it is the mean of the
/// directions' own coefficients. Throws `std::invalid_argument` where the bins differ or a
/// histogram is empty.
double bhattacharyya_coefficient(const BearingRangeHistogram& a, const BearingRangeHistogram& b);

/// The Bhattacharyya distance −ln Σ √(p q) [bhattacharyya43]: 0 for equal histograms, infinite
/// where they share no bin. [deschaud12] gives no equation; its Table I has a value above 1, which
/// rules out the bounded form √(1 − Σ √(p q)).
double bhattacharyya_distance(const BearingRangeHistogram& a, const BearingRangeHistogram& b);

/// The coefficient of one direction, p and q normalised within it.
struct DirectionOverlap {
  uint16_t ring = 0, bearing = 0;
  double coefficient = 0;
};
/// Of every direction in which `a` has a beam, in order; 0 where `b` has none.
std::vector<DirectionOverlap> direction_overlaps(const BearingRangeHistogram& a,
                                                 const BearingRangeHistogram& b);

}  // namespace underbrush::metrics
