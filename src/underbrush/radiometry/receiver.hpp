/// \file
/// The receiver of a sensor: returns of a beam's sub-rays in, reported echoes out.
#pragma once
#include <cstdint>
#include <limits>
#include <span>

#include "underbrush/radiometry/detector.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::radiometry {

using sensor::Intensity;
using sensor::ReturnMode;

/// A receiver. Signals are in units of the noise in the dark.
struct ReceiverOptions {
  ResponseOptions response;
  DetectorOptions detector;  ///< Threshold: a signal-to-noise ratio, times `noise_sigma`.
                             ///< Saturation: from the converter.
  double min_range_m = 0, max_range_m = 120;  ///< Echoes outside are not reported.
  double signal_at_1m = 1e5;    ///< Of a white Lambertian target, perpendicular, all of the beam.
  double extinction_per_m = 0;  ///< Of the air, one way.
  double noise_sigma = 1;       ///< Above 1 in sunlight (`noise_in_light`); 0 = no noise.
  bool false_alarms = true;     ///< Noise alone passes the threshold as often as it should.
  float adc_step = 0;           ///< Of the digitised signal.
  float adc_most = std::numeric_limits<float>::infinity();  ///< Where it saturates.
  double range_sigma_m = 0;       ///< Jitter of the range, besides what noise does to the pulse.
  double range_resolution_m = 0;  ///< Ranges are rounded to the nearest multiple.
  Intensity intensity = Intensity::kSignal;
  double intensity_scale = 1;  ///< Reported intensity of a signal, or a reflectance, of 1.
  double intensity_resolution = 0;
  double intensity_most = std::numeric_limits<double>::infinity();
  double width_resolution_m = 0;  ///< Pulse widths are rounded to the nearest multiple.
  ReturnMode mode = ReturnMode::kStrongest;
  int max_echoes = 1;  ///< With `kAll`, up to `Echoes::kMost`.

  /// Throws `std::invalid_argument` where a value is out of its range.
  void check() const;
};

/// The receiver of a sensor in this air and light: its signal chain, ranges, accuracy and steps.
/// The signal is calibrated in clear air and in the dark, to the sensor's detection range.
ReceiverOptions receiver_options(const sensor::Sensor& sensor, double extinction_per_m = 0,
                                 double noise_sigma = 1);

/// Signal at 1 m of a sensor that just detects (signal = `threshold`) a perpendicular Lambertian
/// target of this reflectance at this range: threshold · R² e^{2αR} / ρ.
double signal_from_detection_range(double range_m, double reflectance, double threshold,
                                   double extinction_per_m);

/// The receiving end of one sensor; immutable, for any number of threads, each with its own
/// scratch.
///
/// A sub-ray's return is a range (m; infinite or NaN: none), the weight of the sub-ray (its share
/// of the beam's energy) and a reflection factor: reflectance × what the incidence leaves of it (1
/// = a white Lambertian surface seen perpendicularly; `backscatter`,
/// `LeafAngleDistribution::backscatter`).
class Receiver {
 public:
  explicit Receiver(const ReceiverOptions& options);
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  const ReceiverOptions& options() const { return options_; }
  const Response& response() const { return response_; }
  /// A waveform to work in; the receiver must outlive it.
  Waveform scratch() const { return Waveform(response_, options_.max_range_m); }

  /// Peak signal of each return by the lidar equation for targets wider than the sub-ray:
  /// signal_at_1m · weight · factor · e^{−2αr} / r². Ranges below 1 cm count as 1 cm.
  void signals(std::span<const float> range_m, std::span<const float> weight,
               std::span<const float> factor, std::span<float> signal) const;

  /// The echoes of one beam; `scratch` holds its digitised waveform afterwards. The four spans are
  /// equally long; `signal` is overwritten. Random numbers: `Purpose::kSignal` of `key`.
  Echoes receive(std::span<const float> range_m, std::span<const float> weight,
                 std::span<const float> factor, std::span<float> signal, uint64_t key,
                 Waveform& scratch) const;
  /// The same from signals that are known.
  Echoes receive(std::span<const float> range_m, std::span<const float> signal, uint64_t key,
                 Waveform& scratch) const;

 private:
  void add_false_alarm(const Waveform& waveform, uint64_t key, Echoes& echoes) const;
  void report(uint64_t key, Echoes& echoes) const;

  ReceiverOptions options_;
  Response response_;
  Detector detector_;
  float threshold_;
  double exceedance_ = 0;  ///< Probability that a sample of noise passes the threshold.
};

}  // namespace underbrush::radiometry
