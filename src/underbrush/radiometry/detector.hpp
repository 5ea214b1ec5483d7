/// \file
/// Echoes in a waveform: threshold, peak or leading edge, separation, pulse width.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/radiometry/waveform.hpp"

namespace underbrush::radiometry {

/// What a sensor reports of one echo.
struct Echo {
  float range_m = 0;
  float peak = 0;       ///< Highest signal, in units of the noise in the dark.
  float width_m = 0;    ///< Echo pulse width: length of the signal above the threshold.
  float energy = 0;     ///< ∫ s dr / ∫ h dr: of a separate surface, the sum of its amplitudes.
  float intensity = 0;  ///< In the sensor's unit; the receiver sets it.
};

/// The echoes of one beam in order of range.
struct Echoes {
  static constexpr int kMost = 16;
  std::array<Echo, kMost> echo;
  int count = 0;

  const Echo* begin() const { return echo.data(); }
  const Echo* end() const { return echo.data() + count; }
  /// Appends; beyond `kMost` the last place is overwritten, so that the last echo is kept.
  void push(const Echo& e);
};

using sensor::Timing;

/// How echoes are told.
struct DetectorOptions {
  Timing timing = Timing::kPeak;
  float threshold = 5;  ///< Of the signal.
  /// Two maxima are two echoes where the signal between falls below this share of the lower one.
  float valley = 0.7F;
  float min_gap_m = 0;  ///< Of two echoes nearer together than this the stronger one stays.
};

/// Finds echoes. Both timings are unbiased for a point target: the published code's range cells
/// ([rosenberger20], rounded up) are not.
class Detector {
 public:
  /// Calibrates both timings on the response. Throws `std::invalid_argument` unless threshold
  /// and valley are positive and valley ≤ 1.
  Detector(const Response& response, const DetectorOptions& options);

  /// All echoes of the waveform at `threshold` (≥ 0 replaces that of the options).
  Echoes detect(const Waveform& waveform, float threshold = -1) const;

 private:
  struct Pulse;
  void close(const Waveform& w, const Pulse& pulse, float threshold, Echoes& echoes) const;
  double walk_m(double peak, double threshold) const;
  double peak_bias_m(double place) const;
  void calibrate(const Response& response);
  void calibrate_peak(const Response& response);

  DetectorOptions options_;
  std::vector<double> walk_m_;  ///< Target − crossing over log₂(peak/threshold).
  /// Parabola − target on this response, over where the parabola's vertex lies, −½ to ½ sample.
  std::vector<double> peak_bias_m_;
};

}  // namespace underbrush::radiometry
