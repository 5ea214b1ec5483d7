/// \file
/// This file computes the range of a pulse in a waveform.
#pragma once
#include <vector>

#include "underbrush/radiometry/waveform.hpp"
#include "underbrush/sensor/signal.hpp"

namespace underbrush::radiometry {

using sensor::Timing;

/// The extent of a pulse, in samples of its waveform.
struct PulseSpan {
  size_t begin = 0;             ///< First sample of the pulse.
  size_t top = 0, top_end = 0;  ///< First and last sample of its highest level.
  double rise = 0;              ///< Place at which it passes the threshold, or place of its valley.
  bool from_valley = false;     ///< Whether it rises out of another pulse.
};

/// The range of a pulse, and its height in units of the waveform.
struct PulseTime {
  double range_m = 0;
  double height = 0;
};

/// Computes ranges of pulses without bias for a point target.
///
/// Timing at the peak and at a constant fraction interpolates between samples. Its bias depends
/// only on where between two samples the interpolated place lies, and is tabulated from the
/// response. The leading edge is corrected by the height of the pulse.
///
/// A saturated pulse has no maximum, but its flanks remain. Let s_a be the last sample before the
/// plateau and s_b the first one after it, at distance d. The target lies where h(x) / h(x + d) =
/// s_a / s_b with x = r_a − r. The ratio rises with x for every pulse whose logarithm is concave,
/// which holds for all of `Pulse`, so bisection finds x. Real receivers correct by the pulse width
/// in the same way; here the width is known to a fraction of a sample. Where a flank's sample is
/// below the threshold, the pulse rises from there to saturation within one sample, and the middle
/// of the possible places is taken.
class PulseTiming {
 public:
  /// Calibrates the timing for a response. `saturation` is the level at which the signal is cut;
  /// infinity means never.
  PulseTiming(const Response& response, Timing timing, float threshold, float saturation);

  /// Computes the range and height of a pulse above `threshold`. The waveform must have the
  /// response of the calibration.
  PulseTime time(const Waveform& w, const PulseSpan& pulse, double threshold) const;

  /// Finds the place between samples k−1 and k where the signal passes `level`. It interpolates the
  /// logarithm linearly, which flanks of pulses nearly follow.
  static double crossing(const float* s, size_t k, double level);

 private:
  /// A place, in samples, and the part of a sample that its bias depends on, 0 to 1.
  struct Place {
    double at = 0, part = 0;
  };
  using Table = std::vector<double>;

  double walk_m(double peak, double threshold) const;
  double saturated_m(const Waveform& w, const PulseSpan& pulse, double threshold) const;
  /// Finds the place where the front passes half of `height`. Returns false if it does not do so
  /// within the pulse.
  static bool half_height(const float* s, const PulseSpan& pulse, double height, Place& place);
  static Table walk_table(const Response& response, float threshold);
  static Table bias_table(const Response& response, Timing timing);
  static double look_up(const Table& table, double part);

  Timing timing_;
  float saturation_;
  Table walk_m_;       ///< Target − crossing, by log₂(peak/threshold).
  Table peak_bias_m_;  ///< Parabola − target, by the place of the vertex, −½ to ½ sample.
  Table half_bias_m_;  ///< Crossing of half the peak − target, by the part of a sample.
};

}  // namespace underbrush::radiometry
