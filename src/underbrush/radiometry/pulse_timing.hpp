/// \file
/// Which range a pulse in a waveform stands for.
#pragma once
#include <vector>

#include "underbrush/radiometry/waveform.hpp"
#include "underbrush/sensor/signal.hpp"

namespace underbrush::radiometry {

using sensor::Timing;

/// A pulse, in samples of its waveform.
struct PulseSpan {
  size_t begin = 0;             ///< First sample of it.
  size_t top = 0, top_end = 0;  ///< First and last sample of its highest level.
  double rise = 0;              ///< Where it passes the threshold, or its valley.
  bool from_valley = false;     ///< It rises out of another pulse.
};

/// A pulse's range, and its height in units of the waveform.
struct PulseTime {
  double range_m = 0;
  double height = 0;
};

/// Gives pulses their ranges, unbiased for a point target. Peak and constant fraction are exact up
/// to the bias of interpolating between samples, which depends only on where between two samples
/// the interpolated place lies: it is tabulated from the response. The leading edge is corrected
/// by the height of the pulse.
///
/// A saturated pulse has no maximum. Its flanks are left: with the last sample before and the first
/// after the plateau, s_a and s_b at distance d, the target lies where h(x) / h(x + d) = s_a / s_b,
/// x = r_a − r. The ratio rises with x for every pulse whose logarithm is concave, as all of
/// `Pulse` are; bisection finds x. It is the correction by pulse width of real receivers, with the
/// width known to a fraction of a sample. Where a flank's sample is below the threshold, the pulse
/// passes from below it to saturation within one sample: the middle of what that leaves.
class PulseTiming {
 public:
  /// Calibrates on the response. `saturation`: level at which the signal is cut; infinite: never.
  PulseTiming(const Response& response, Timing timing, float threshold, float saturation);

  /// Of a pulse of a waveform with the same response, above `threshold`.
  PulseTime time(const Waveform& w, const PulseSpan& pulse, double threshold) const;

  /// Where between samples k−1 and k the signal passes `level`: linear in its logarithm, as the
  /// flanks of a pulse nearly are.
  static double crossing(const float* s, size_t k, double level);

 private:
  /// A place, in samples, and the part of a sample that its bias depends on, 0 to 1.
  struct Place {
    double at = 0, part = 0;
  };
  using Table = std::vector<double>;

  double walk_m(double peak, double threshold) const;
  double saturated_m(const Waveform& w, const PulseSpan& pulse, double threshold) const;
  /// Where the front passes half of `height`, if it does so within the pulse.
  static bool half_height(const float* s, const PulseSpan& pulse, double height, Place& place);
  static Table walk_table(const Response& response, float threshold);
  static Table bias_table(const Response& response, Timing timing);
  static double look_up(const Table& table, double part);

  Timing timing_;
  float saturation_;
  Table walk_m_;       ///< Target − crossing over log₂(peak/threshold).
  Table peak_bias_m_;  ///< Parabola − target over where its vertex lies, −½ to ½ sample.
  Table half_bias_m_;  ///< Crossing of half the peak − target over the part of a sample.
};

}  // namespace underbrush::radiometry
