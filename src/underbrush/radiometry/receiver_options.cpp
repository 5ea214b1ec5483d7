#include "underbrush/radiometry/receiver_options.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::radiometry {

void ReceiverOptions::check() const {
  const auto not_negative = [](double v) { return std::isfinite(v) && v >= 0; };
  require(not_negative(min_range_m) && std::isfinite(max_range_m) && min_range_m < max_range_m,
          "receiver: needs 0 <= minimum range < maximum range");
  require(not_negative(signal_at_1m) && not_negative(extinction_per_m) &&
              not_negative(noise_sigma) && not_negative(sunlit_variance) &&
              not_negative(range_sigma_m),
          "receiver: signal, extinction, noise or jitter is negative or not finite");
  require(not_negative(range_resolution_m) && not_negative(intensity_resolution) &&
              not_negative(width_resolution_m) && adc_step >= 0 && std::isfinite(adc_step),
          "receiver: a resolution is negative or not finite");
  require(adc_most > 0 && intensity_most > 0, "receiver: a full scale is not positive");
  require(max_echoes >= 1 && max_echoes <= Echoes::kMost, "receiver: 1 to 16 echoes");
}

double signal_from_detection_range(double range_m, double reflectance, double threshold,
                                   double extinction_per_m) {
  require(range_m > 0 && reflectance > 0 && threshold > 0, "detection range: not positive");
  return threshold * range_m * range_m * std::exp(2 * extinction_per_m * range_m) / reflectance;
}

ReceiverOptions receiver_options(const sensor::Sensor& s, double extinction_per_m,
                                 double sunlit_variance) {
  const sensor::SignalChain& c = s.signal;
  ReceiverOptions o;
  o.response = {c.pulse, c.pulse_fwhm_s, c.receiver_fwhm_s, c.sample_s};
  o.detector.timing = c.timing;
  o.detector.threshold = float(c.threshold_snr);
  o.detector.min_gap_m = float(c.min_gap_m);
  o.min_range_m = s.min_range_m;
  o.max_range_m = s.max_range_m;
  o.signal_at_1m =
      signal_from_detection_range(c.detection_range_m > 0 ? c.detection_range_m : s.max_range_m,
                                  c.detection_reflectance, c.threshold_snr, 0);
  o.extinction_per_m = extinction_per_m;
  o.sunlit_variance = sunlit_variance;
  o.adc_most = float(c.saturation_snr);
  o.adc_step = float(c.adc_step_snr);
  o.range_sigma_m = s.range_sigma_m;
  o.range_resolution_m = s.range_resolution_m;
  o.intensity = c.intensity;
  o.intensity_scale = c.intensity_scale;
  o.intensity_resolution = c.intensity_resolution;
  o.intensity_most = c.intensity_most;
  o.width_resolution_m = c.width_resolution_m;
  o.mode = c.mode;
  o.max_echoes = c.max_echoes;
  return o;
}

}  // namespace underbrush::radiometry
