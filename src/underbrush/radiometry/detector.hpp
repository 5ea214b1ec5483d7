/// \file
/// This file finds echoes in a waveform by a threshold, separates them, and measures their pulse
/// widths.
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include "underbrush/radiometry/pulse_timing.hpp"

namespace underbrush::radiometry {

/// An echo as a sensor reports it.
struct Echo {
  float range_m = 0;
  float peak = 0;       ///< Highest signal, in units of the noise in the dark.
  float width_m = 0;    ///< Echo pulse width: the length of the signal above the threshold.
  float energy = 0;     ///< ∫ s dr / ∫ h dr; for a separate surface, the sum of its amplitudes.
  float intensity = 0;  ///< In the sensor's unit; set by the receiver.
};

/// The echoes of a beam in order of range.
struct Echoes {
  static constexpr int kMost = 16;
  std::array<Echo, kMost> echo;
  int count = 0;

  const Echo* begin() const { return echo.data(); }
  const Echo* end() const { return echo.data() + count; }
  /// Appends an echo. Beyond `kMost` it overwrites the last place, so that the last echo is kept.
  void push(const Echo& e);
};

/// The options of echo detection.
struct DetectorOptions {
  Timing timing = Timing::kPeak;
  float threshold = 5;  ///< Least signal of an echo, in units of the waveform.
  /// Two maxima are two echoes if the signal between them falls below this share of the lower one.
  float valley = 0.7F;
  float min_gap_m = 0;  ///< Least distance of two echoes; nearer ones are one: the range is that of
                        ///< the stronger, and the pulse reaches from one to the other.
  /// σ of the noise, in units of the waveform. A pulse ends only where the signal falls 3 σ below
  /// the threshold, and two maxima are two echoes only where they rise 5 σ above the signal between
  /// them.
  float noise = 0;
  /// Level at which the signal is cut, in units of the waveform.
  float saturation = std::numeric_limits<float>::infinity();

  /// Throws `std::invalid_argument` unless threshold, valley and saturation are positive and valley
  /// ≤ 1.
  void check() const;
};

/// A detector of echoes. All timings are unbiased for a point target, unlike the published code of
/// [rosenberger20], which rounds range cells up.
class Detector {
 public:
  /// Calibrates the timing for a response. Throws as `DetectorOptions::check` does.
  Detector(const Response& response, const DetectorOptions& options);

  /// Finds all echoes of a waveform whose noise, and with it the threshold, is `scale` times that
  /// of the options.
  Echoes detect(const Waveform& waveform, float scale = 1) const;

 private:
  struct Pulse;
  void close(const Waveform& w, const Pulse& pulse, float threshold, double& joined,
             Echoes& echoes) const;

  /// Whether the signal falls enough from the lower of two maxima, `peak`, for two echoes.
  bool is_valley(float low, float peak, float noise) const;

  DetectorOptions options_;
  PulseTiming timing_;
};

}  // namespace underbrush::radiometry
