/// \file
/// Echoes in a waveform: threshold, separation, pulse width.
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "underbrush/radiometry/pulse_timing.hpp"

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

/// How echoes are told.
struct DetectorOptions {
  Timing timing = Timing::kPeak;
  float threshold = 5;  ///< Of the signal.
  /// Two maxima are two echoes where the signal between falls below this share of the lower one.
  float valley = 0.7F;
  float min_gap_m = 0;  ///< Of two echoes nearer together than this the stronger one stays.
  /// Level at which the signal is cut.
  float saturation = std::numeric_limits<float>::infinity();

  /// Throws `std::invalid_argument` unless threshold, valley and saturation are positive and valley
  /// ≤ 1.
  void check() const;
};

/// Finds echoes. All timings are unbiased for a point target: the published code's range cells
/// ([rosenberger20], rounded up) are not.
class Detector {
 public:
  /// Calibrates its timing on the response. Throws as `DetectorOptions::check`.
  Detector(const Response& response, const DetectorOptions& options);

  /// All echoes of the waveform at `threshold` (≥ 0 replaces that of the options).
  Echoes detect(const Waveform& waveform, float threshold = -1) const;

 private:
  struct Pulse;
  void close(const Waveform& w, const Pulse& pulse, float threshold, Echoes& echoes) const;

  DetectorOptions options_;
  PulseTiming timing_;
};

}  // namespace underbrush::radiometry
