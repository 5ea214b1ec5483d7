/// \file
/// This file has the receiver of a sensor, which turns the returns of a beam's sub-rays into
/// reported echoes.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "underbrush/radiometry/lone_echo.hpp"
#include "underbrush/radiometry/receiver_options.hpp"

namespace underbrush::radiometry {

/// The receiving end of a sensor. It is immutable and may be used by any number of threads, each
/// with a scratch of its own.
///
/// The return of a sub-ray is a range (m; infinite or NaN for none), the weight of the sub-ray (its
/// share of the beam's energy) and a reflection factor. The factor is the reflectance times the
/// effect of the incidence; it is 1 for a white Lambertian surface that is hit perpendicularly
/// (`backscatter`, `LeafAngleDistribution::backscatter`).
class Receiver {
 public:
  explicit Receiver(const ReceiverOptions& options);
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  const ReceiverOptions& options() const { return options_; }
  const Response& response() const { return response_; }
  /// Makes a waveform to work in. The receiver must outlive it.
  Waveform scratch() const { return Waveform(response_, options_.max_range_m); }

  /// Computes the peak signal of each return by the lidar equation for targets wider than the
  /// sub-ray: signal_at_1m · weight · factor · e^{−2αr} / r². Ranges below 1 cm count as 1 cm.
  void signals(std::span<const float> range_m, std::span<const float> weight,
               std::span<const float> factor, std::span<float> signal) const;

  /// The noise of a beam, in units of that of the options: √(1 + v b) with the sunlit variance v.
  /// The brightness b of the beam's view is the sum of the returns' weights times their factors,
  /// attenuated by the air on the way back, as if the sun stood behind the sensor; the rest of the
  /// view is clear sky, of 3 % of a white scene's brightness.
  float noise_scale(std::span<const float> range_m, std::span<const float> weight,
                    std::span<const float> factor) const;

  /// Computes the echoes of one beam. The four spans are equally long, and `signal` is overwritten.
  /// The echo of a return that stands alone, clear of the threshold and of saturation, is drawn
  /// from the moments of its echoes (`LoneEcho`), unless `way` is `kByWaveform`; other beams have
  /// their waveform made. `scratch` then holds the digitised waveform afterwards. Random numbers
  /// are those of `Purpose::kSignal` of `key`.
  enum class Way { kFast, kByWaveform };
  Echoes receive(std::span<const float> range_m, std::span<const float> weight,
                 std::span<const float> factor, std::span<float> signal, uint64_t key,
                 Waveform& scratch, Way way = Way::kFast) const;
  /// Computes the echoes of one beam from signals that are known, and its `noise_scale`.
  Echoes receive(std::span<const float> range_m, std::span<const float> signal, uint64_t key,
                 Waveform& scratch, float noise_scale = 1, Way way = Way::kFast) const;

 private:
  Echoes echoes_of(std::span<const float> range_m, std::span<const float> signal, uint64_t key,
                   Waveform& scratch, float noise_scale) const;
  void measure_lone_echo();
  void add_false_alarm(size_t free_samples, uint64_t key, double noise, Echoes& echoes) const;
  void report(uint64_t key, float noise_scale, Echoes& echoes) const;
  void measure_jitter();
  double range_variance(double snr) const;
  double jitter_m(double peak, double noise_scale) const;

  ReceiverOptions options_;
  Response response_;
  Detector detector_;
  std::optional<LoneEcho> lone_;
  float lone_most_ = 0;  ///< The greatest signal of a lone return that certainly does not saturate.
  double exceedance_ = 0;  ///< Probability that a sample of noise is above the threshold.
  double alarms_ = 0;      ///< Probability that noise passes the threshold upwards at a sample.
  double noise_variance_m2_ = 0;     ///< Variance of the range by noise, times the signal squared.
  double sampling_variance_m2_ = 0;  ///< Variance of the range by the place within a sample.
};

}  // namespace underbrush::radiometry
