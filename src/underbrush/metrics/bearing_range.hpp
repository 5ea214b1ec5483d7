/// \file
/// This file has histograms of the beams of a static lidar, over laser, bearing and range, and
/// measures of their overlap ([deschaud12] §VI.A).
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// The sizes of the bins. The defaults are the encoder's step and the range's step of the HDL-64E.
struct BearingRangeBins {
  double bearing_rad = 2 * M_PI / 4000;
  double range_m = 0.002;
};

/// A histogram of beams by (laser, bearing, range). Beams without a return have a range bin of
/// their own. Memory holds the occupied bins and one chunk of beams.
class BearingRangeHistogram {
 public:
  /// An occupied bin. It reaches half a step to each side of the bearing `bearing · step`,
  /// counter-clockwise from the sensor's x axis, and over the ranges [range, range + 1) steps.
  struct Bin {
    uint16_t ring = 0;
    uint16_t bearing = 0;
    uint32_t range = kNoReturn;
    uint32_t count = 0;
  };
  static constexpr uint32_t kNoReturn = 0xffffffffu;

  /// Makes an empty histogram. Throws `std::invalid_argument` where a step is not positive or a
  /// turn has more than 2¹⁶ bearings.
  explicit BearingRangeHistogram(const BearingRangeBins& bins = {},
                                 const Pose& world_from_sensor = {});

  /// Adds beams by their reported direction and range.
  void add(const BeamLog& beams);
  /// Adds the beams of another histogram. Throws `std::invalid_argument` where the bins differ.
  void add(const BearingRangeHistogram& other);

  const BearingRangeBins& bins() const { return bins_; }
  /// The occupied bins in order of ring, bearing and range; the bin without a return comes last.
  const std::vector<Bin>& occupied() const { return occupied_; }
  uint64_t total() const { return total_; }

 private:
  BearingRangeBins bins_;
  Pose sensor_from_world_;
  std::vector<Bin> occupied_;
  uint64_t total_ = 0;
};

/// Computes the Bhattacharyya coefficient Σ √(p q) over all bins, with p and q the normalised
/// counts. It is 1 for equal histograms and 0 for histograms that share no bin. If both have
/// equally many beams in every direction, it is the mean of the directions' coefficients. Throws
/// `std::invalid_argument` where the bins differ or a histogram is empty.
double bhattacharyya_coefficient(const BearingRangeHistogram& a, const BearingRangeHistogram& b);

/// Computes the Bhattacharyya distance −ln Σ √(p q) [bhattacharyya43]. It is 0 for equal histograms
/// and infinite for histograms that share no bin. [deschaud12] gives no equation, but its Table I
/// has a value above 1, which rules out the bounded form √(1 − Σ √(p q)).
double bhattacharyya_distance(const BearingRangeHistogram& a, const BearingRangeHistogram& b);

/// The Bhattacharyya coefficient of one direction, with p and q normalised within it.
struct DirectionOverlap {
  uint16_t ring = 0, bearing = 0;
  double coefficient = 0;
};
/// Computes the overlap of every direction in which `a` has a beam, in order of ring and bearing.
/// It is 0 where `b` has no beam.
std::vector<DirectionOverlap> direction_overlaps(const BearingRangeHistogram& a,
                                                 const BearingRangeHistogram& b);

}  // namespace underbrush::metrics
