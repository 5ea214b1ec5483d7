/// \file
/// The receiving end of a sensor as its data file describes it; `radiometry` acts on it.
#pragma once
#include <cstdint>

namespace underbrush::sensor {

/// Shape of the emitted pulse over time.
enum class Pulse : uint8_t {
  kGaussian,
  kQSwitched,  ///< (t/τ)² exp(−t/τ), the fast rise and slow fall of Q-switched lasers
               ///< ([steinvall00]).
};

/// Where in a pulse its range is taken.
enum class Timing : uint8_t {
  kPeak,              ///< At the maximum, by a parabola through the logarithms of three samples.
  kLeadingEdge,       ///< Where it rises through the threshold, corrected for the height of the
                      ///< peak; of a pulse that rises out of a valley, the peak.
  kConstantFraction,  ///< Where it rises through half of its peak; of a pulse that rises out of a
                      ///< higher valley, the peak.
};

/// Which echoes of a beam a sensor reports.
enum class ReturnMode : uint8_t {
  kStrongest,  ///< The one of most energy.
  kFirst,
  kLast,
  kAll,  ///< The first `max_echoes`.
};

/// What the intensity of an echo stands for.
enum class Intensity : uint8_t {
  kSignal,       ///< The peak of the signal.
  kReflectance,  ///< The peak over that of a white, perpendicular target at the echo's range.
};

/// From light to echoes.
struct SignalChain {
  Pulse pulse = Pulse::kGaussian;
  double pulse_fwhm_s = 5e-9;
  double receiver_fwhm_s = 0;  ///< Of the receiver's Gaussian impulse response; 0 = ideal.
  double sample_s = 1e-9;      ///< Between samples of the analog–digital converter.
  Timing timing = Timing::kPeak;
  double threshold_snr = 5;      ///< Signal-to-noise ratio from which an echo is reported.
  double detection_range_m = 0;  ///< A target of `detection_reflectance` is just detected here;
  double detection_reflectance = 0.1;  ///< 0 m: at the maximum range.
  double min_gap_m = 0;                ///< Of two echoes nearer together the stronger one stays.
  double saturation_snr = 4000;        ///< Where the converter ends.
  ReturnMode mode = ReturnMode::kStrongest;
  int max_echoes = 1;  ///< With `kAll`.
  Intensity intensity = Intensity::kReflectance;
  double intensity_scale = 100;  ///< Reported intensity of a signal, or a reflectance, of 1.
  double intensity_resolution = 1;
  double intensity_most = 255;
  double width_resolution_m = 0;  ///< Step of the echo pulse width.

  /// Throws `std::invalid_argument` where a value is not finite or out of its range.
  void check() const;
};

}  // namespace underbrush::sensor
