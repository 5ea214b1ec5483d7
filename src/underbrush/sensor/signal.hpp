/// \file
/// This file has the receiving end of a sensor as its data file describes it. The module
/// `radiometry` simulates it.
#pragma once
#include <cstdint>

namespace underbrush::sensor {

/// The shape of the emitted pulse over time.
enum class Pulse : uint8_t {
  kGaussian,
  kQSwitched,  ///< (t/τ)² exp(−t/τ), the fast rise and slow fall of Q-switched lasers
               ///< ([steinvall00]).
};

/// The way in which the range of a pulse is measured.
enum class Timing : uint8_t {
  kPeak,              ///< At the maximum, by a parabola through the logarithms of three samples.
  kLeadingEdge,       ///< At the rise through the threshold, corrected for the height of the peak;
                      ///< for a pulse that rises out of a valley, at the peak.
  kConstantFraction,  ///< At the rise through half of the peak; for a pulse that rises out of a
                      ///< higher valley, at the peak.
};

/// The echoes of a beam that a sensor reports.
enum class ReturnMode : uint8_t {
  kStrongest,  ///< The echo with the most energy.
  kFirst,
  kLast,
  kAll,  ///< The strongest `max_echoes`, in order of range.
};

/// The quantity that the intensity of an echo stands for.
enum class Intensity : uint8_t {
  kSignal,       ///< Peak of the signal.
  kReflectance,  ///< Peak divided by that of a white, perpendicular target at the echo's range.
};

/// A pulse after the receiver must be shorter than this many samples (full width at half maximum).
inline constexpr double kMostSamplesOfPulse = 500;

/// The signal chain of a sensor, from the emitted pulse to the reported echoes.
struct SignalChain {
  Pulse pulse = Pulse::kGaussian;
  double pulse_fwhm_s = 5e-9;
  double receiver_fwhm_s = 0;  ///< Width of the receiver's Gaussian impulse response; 0 = ideal.
  double sample_s = 1e-9;      ///< Time between samples of the analog–digital converter.
  Timing timing = Timing::kPeak;
  double threshold_snr = 5;  ///< Least signal-to-noise ratio of a reported echo.
  /// Range at which a target of `detection_reflectance` is just detected; 0 = maximum range.
  double detection_range_m = 0;
  double detection_reflectance = 0.1;
  double min_gap_m = 0;          ///< Least distance of echoes; of nearer ones, the stronger stays.
  double saturation_snr = 4000;  ///< Signal-to-noise ratio at the converter's upper limit.
  double adc_step_snr = 0;       ///< Step of the converter, in units of the noise; 0 = none.
  ReturnMode mode = ReturnMode::kStrongest;
  int max_echoes = 1;  ///< For `kAll`.
  Intensity intensity = Intensity::kReflectance;
  double intensity_scale = 100;  ///< Reported intensity of a signal, or of a reflectance, of 1.
  double intensity_resolution = 1;
  double intensity_most = 255;
  double width_resolution_m = 0;  ///< Step of the echo pulse width.

  /// Throws `std::invalid_argument` where a value is not finite or out of its range.
  void check() const;
};

}  // namespace underbrush::sensor
