/// \file
/// The options of a sensor's receiver, and their derivation from the sensor's data.
#pragma once
#include <limits>

#include "underbrush/radiometry/detector.hpp"
#include "underbrush/radiometry/response.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::radiometry {

using sensor::Intensity;
using sensor::ReturnMode;

/// The options of a receiver. Signals are in units of the noise in the dark.
struct ReceiverOptions {
  ResponseOptions response;
  /// Its threshold is a signal-to-noise ratio, which is multiplied by the noise of each beam; its
  /// saturation is set from the converter.
  DetectorOptions detector;
  double min_range_m = 0, max_range_m = 120;  ///< Echoes outside are not reported.
  /// Signal of a white, Lambertian, perpendicular target that all of the beam hits.
  double signal_at_1m = 1e5;
  double extinction_per_m = 0;  ///< Extinction of the air, one way.
  double noise_sigma = 1;       ///< Noise in the dark; 0 = no noise.
  /// The variance that sunlight from a white scene in all of the view adds to the noise, in units
  /// of its variance in the dark.
  double sunlit_variance = 0;
  bool false_alarms = true;  ///< Whether noise alone passes the threshold as often as it should.
  float adc_step = 0;        ///< Step of the digitised signal; 0 = none.
  /// Signal at which the converter saturates.
  float adc_most = std::numeric_limits<float>::infinity();
  double range_sigma_m =
      0;  ///< Standard deviation of the range of a flat target, the effect of noise
          ///< on its pulse included; a weak pulse may have more from noise alone.
  double range_resolution_m = 0;  ///< Ranges are rounded to the nearest multiple.
  Intensity intensity = Intensity::kSignal;
  double intensity_scale = 1;  ///< Reported intensity of a signal, or of a reflectance, of 1.
  double intensity_resolution = 0;
  double intensity_most = std::numeric_limits<double>::infinity();
  double width_resolution_m = 0;  ///< Pulse widths are rounded to the nearest multiple.
  ReturnMode mode = ReturnMode::kStrongest;
  int max_echoes = 1;  ///< For `kAll`, up to `Echoes::kMost`.

  /// Throws `std::invalid_argument` where a value is out of its range.
  void check() const;
};

/// Makes the options of a sensor's receiver from its signal chain, ranges, accuracy and steps, in
/// air of this extinction and in light of this `ReceiverOptions::sunlit_variance`. The signal is
/// calibrated to the sensor's detection range in clear air and in the dark.
ReceiverOptions receiver_options(const sensor::Sensor& sensor, double extinction_per_m = 0,
                                 double sunlit_variance = 0);

/// Computes the signal at 1 m of a sensor that just detects (signal = `threshold`) a perpendicular
/// Lambertian target of this reflectance ρ at this range R: threshold · R² e^{2αR} / ρ.
double signal_from_detection_range(double range_m, double reflectance, double threshold,
                                   double extinction_per_m);

}  // namespace underbrush::radiometry
