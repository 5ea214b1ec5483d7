#include "underbrush/radiometry/receiver.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/clones.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::radiometry {
namespace {

// Elements of `Purpose::kSignal` besides the numbers of samples.
constexpr uint32_t kFalseAlarm = 0xFFFF0000, kJitter = 0xFFFF1000;
/// Returns that lie within this share of the pulse's length look like one.
constexpr float kOneTarget = 0.05f;
constexpr double kSkyBrightness = 0.03;  // of clear sky away from the sun, in the near infrared

/// Computes k w f e^{−a r} / r². Its e^−x has a relative error below 3·10⁻⁷.
UNDERBRUSH_CLONES void signal_of(size_t n, const float* __restrict range,
                                 const float* __restrict weight, const float* __restrict factor,
                                 float k, float a, float* __restrict signal) {
  for (size_t i = 0; i < n; ++i) {
    const float far = range[i] < 1e9f ? range[i] : 1e9f;  // also replaces NaN
    const float r = far > 0.01f ? far : 0.01f;
    const float x = a * 1.44269504f * r, y = x < 60 ? x : 60;  // avoids denormal numbers
    const int whole = int(y);
    const float f = 0.5f - (y - float(whole));  // 2^(f − ½), f in (−½, ½]
    const float p =
        0.70710678f *
        (1 +
         f * (0.69314718f +
              f * (0.24022651f +
                   f * (0.05550411f + f * (0.00961813f + f * (0.00133336f + f * 0.00015404f))))));
    const float transmission = p * std::bit_cast<float>((127 - whole) << 23);
    signal[i] = k * weight[i] * factor[i] * transmission / (r * r);
  }
}

double rounded(double value, double step) {
  return step > 0 ? step * std::floor(value / step + 0.5) : value;
}

/// Makes the detector's options, with the converter's highest level as its saturation.
DetectorOptions detector_options(const ReceiverOptions& o) {
  DetectorOptions out = o.detector;
  out.saturation =
      o.adc_step > 0 ? o.adc_step * std::nearbyint(o.adc_most / o.adc_step) : o.adc_most;
  out.threshold *= float(o.noise_sigma > 0 ? o.noise_sigma : 1);
  out.noise = float(o.noise_sigma);
  return out;
}

/// Selects the echoes that a sensor in this mode reports, in place.
void select(ReturnMode mode, int most, Echoes& echoes) {
  if (echoes.count == 0) return;
  auto& echo = echoes.echo;
  const auto end = echo.begin() + echoes.count;
  const auto stronger = [](const Echo& a, const Echo& b) {
    return a.energy != b.energy ? a.energy > b.energy : a.range_m < b.range_m;
  };
  switch (mode) {
    case ReturnMode::kAll:
      if (echoes.count <= most) return;
      std::nth_element(echo.begin(), echo.begin() + most, end, stronger);
      std::sort(echo.begin(), echo.begin() + most,
                [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
      echoes.count = most;
      return;
    case ReturnMode::kFirst:
      break;
    case ReturnMode::kLast:
      echo[0] = *(end - 1);
      break;
    case ReturnMode::kStrongest:
      echo[0] = *std::min_element(echo.begin(), end, stronger);
      break;
  }
  echoes.count = 1;
}

/// Computes the probability that noise, which the filter has made, passes the threshold upwards
/// from one sample to the next: of two correlated normal numbers the first is below it and the
/// second is not.
double crossing_rate(double threshold, std::span<const float> filter) {
  double correlation = 0;
  for (size_t k = 1; k < filter.size(); ++k) correlation += double(filter[k - 1] * filter[k]);
  const double spread = std::sqrt(1 - correlation * correlation);
  constexpr int kSteps = 400;
  constexpr double kStep = 8.0 / kSteps;  // of the second number above the threshold, by Simpson
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double x = threshold + k * kStep;
    const double below = 0.5 * std::erfc((correlation * x - threshold) / spread / M_SQRT2);
    const double weight = k == 0 || k == kSteps ? 1 : k % 2 ? 4 : 2;
    sum += weight * below * std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI);
  }
  return sum * kStep / 3;
}

}  // namespace

Receiver::Receiver(const ReceiverOptions& options)
    : options_(options),
      response_(options.response),
      detector_(response_, detector_options(options)) {
  options.check();
  if (options.false_alarms && options.noise_sigma > 0) {
    exceedance_ = 0.5 * std::erfc(double(options.detector.threshold) / M_SQRT2);
    alarms_ = crossing_rate(double(options.detector.threshold), response_.noise_filter());
  }
  if (options.range_sigma_m > 0 && options.noise_sigma > 0) measure_jitter();
  if (options.noise_sigma > 0) measure_lone_echo();
}

void Receiver::signals(std::span<const float> range_m, std::span<const float> weight,
                       std::span<const float> factor, std::span<float> signal) const {
  require(weight.size() == range_m.size() && factor.size() == range_m.size() &&
              signal.size() == range_m.size(),
          "receiver: ranges, weights, factors and signals of equal length are needed");
  signal_of(range_m.size(), range_m.data(), weight.data(), factor.data(),
            float(options_.signal_at_1m), float(2 * options_.extinction_per_m), signal.data());
}

Echoes Receiver::receive(std::span<const float> range_m, std::span<const float> weight,
                         std::span<const float> factor, std::span<float> signal, uint64_t key,
                         Waveform& scratch, Way way) const {
  signals(range_m, weight, factor, signal);
  return receive(range_m, signal, key, scratch, noise_scale(range_m, weight, factor), way);
}

float Receiver::noise_scale(std::span<const float> range_m, std::span<const float> weight,
                            std::span<const float> factor) const {
  if (options_.sunlit_variance == 0) return 1;
  double brightness = 0, sky = 1;
  for (size_t k = 0; k < range_m.size(); ++k) {
    if (!std::isfinite(range_m[k])) continue;
    const double seen =
        double(weight[k]) * std::exp(-options_.extinction_per_m * double(range_m[k]));
    brightness += seen * double(factor[k]);
    sky -= double(weight[k]);
  }
  brightness += kSkyBrightness * std::max(0.0, sky);
  return float(std::sqrt(1 + options_.sunlit_variance * brightness));
}

Echoes Receiver::receive(std::span<const float> range_m, std::span<const float> signal,
                         uint64_t key, Waveform& scratch, float noise_scale, Way way) const {
  const float noise = float(options_.noise_sigma) * noise_scale;
  LoneReturn lone;
  if (lone_ && way == Way::kFast) {
    lone = lone_return(range_m, signal, float(options_.max_range_m),
                       kOneTarget * float(response_.area_m()));
  }
  Echoes echoes;
  size_t touched = 0;
  if (lone.signal > 0 && lone_->covers(lone.signal / noise) && lone.signal <= lone_most_) {
    echoes.push(lone_->draw(lone, lone.signal / noise, key));
    touched = scratch.reach_of(lone.range_m);
  } else {
    echoes = echoes_of(range_m, signal, key, scratch, noise_scale);
    touched = scratch.touched();
  }
  if (alarms_ > 0) add_false_alarm(scratch.size() - touched, key, double(noise), echoes);
  report(key, noise_scale, echoes);
  return echoes;
}

Echoes Receiver::echoes_of(std::span<const float> range_m, std::span<const float> signal,
                           uint64_t key, Waveform& scratch, float noise_scale) const {
  scratch.clear();
  scratch.add(range_m, signal);
  scratch.add_noise(key, float(options_.noise_sigma) * noise_scale);
  if (options_.adc_step > 0 || std::isfinite(options_.adc_most)) {
    scratch.quantise(options_.adc_step, options_.adc_most);
  }
  return detector_.detect(scratch, noise_scale);
}

void Receiver::measure_lone_echo() {
  constexpr double kClear = 6, kMostRatio = 1e5;  // of noise, above the threshold; of the table
  const double noise = options_.noise_sigma;
  lone_most_ = 0.9f * options_.adc_most;
  const double most = std::min(kMostRatio, double(lone_most_) / noise);
  const float reach = std::min(100.0f, float(options_.max_range_m));
  Waveform w(response_, double(reach));
  lone_.emplace(double(options_.detector.threshold) + kClear, most, noise, 0.4f * reach,
                0.5f * reach, [&](float range, float signal, uint64_t key) {
                  return echoes_of({&range, 1}, {&signal, 1}, key, w, 1);
                });
}

// Samples that no return reaches are noise alone. They are not all drawn: one random number decides
// whether one of them passes the threshold, a second one which, and a third one how far.
void Receiver::add_false_alarm(size_t free_samples, uint64_t key, double noise,
                               Echoes& echoes) const {
  const double u = uniform_from_bits(random_bits(key, kFalseAlarm, Purpose::kSignal));
  if (u >= double(free_samples) * alarms_) return;
  const double where = uniform_from_bits(random_bits(key, kFalseAlarm + 1, Purpose::kSignal));
  const double tail = uniform_from_bits(random_bits(key, kFalseAlarm + 2, Purpose::kSignal));
  Echo e;
  e.range_m = float(where * options_.max_range_m);
  e.peak = float(-noise * normal_from_uniform(tail * exceedance_));
  e.width_m = float(response_.cell_m());
  e.energy = float(e.peak * response_.cell_m() / response_.area_m());
  echoes.push(e);
  std::sort(echoes.echo.begin(), echoes.echo.begin() + echoes.count,
            [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
}

// The range of a flat target varies with its place within a sample, and with the noise on its
// waveform in inverse proportion to its signal. Both are measured once, on pulses at many places,
// of a strong and of a weaker signal.
void Receiver::measure_jitter() {
  constexpr double kWeak = 50, kStrong = 2000;  // times the noise
  const double strong = std::min(kStrong, 0.9 * double(options_.adc_most) / options_.noise_sigma);
  const double weak = std::min(kWeak, 0.5 * strong);
  const double a = range_variance(weak), b = range_variance(strong);
  const double per_noise = std::max(0.0, (a - b) / (1 / (weak * weak) - 1 / (strong * strong)));
  noise_variance_m2_ = per_noise * options_.noise_sigma * options_.noise_sigma;
  sampling_variance_m2_ = std::max(0.0, b - per_noise / (strong * strong));
}

// Computes the variance of the range of a target whose signal is `snr` times the noise.
double Receiver::range_variance(double snr) const {
  constexpr int kPulses = 400;
  const float reach = std::min(100.0f, float(options_.max_range_m));
  const float peak = float(snr * options_.noise_sigma);
  Waveform w(response_, double(reach));
  double sum = 0, square = 0;
  int n = 0;
  for (int k = 0; k < kPulses; ++k) {
    const float range = reach * (0.4f + 0.1f * float(k) / kPulses);
    w.clear();
    w.add({&range, 1}, {&peak, 1});
    w.add_noise(mix64(uint64_t(k)), float(options_.noise_sigma));
    const Echoes echoes = detector_.detect(w);
    if (echoes.count != 1) continue;
    const double error = double(echoes.echo[0].range_m) - double(range);
    sum += error, square += error * error, ++n;
  }
  return n == 0 ? 0 : std::max(0.0, square / n - sum / n * (sum / n));
}

double Receiver::jitter_m(double peak, double noise_scale) const {
  const double all = options_.range_sigma_m, p = std::max(peak, 1e-9) / noise_scale;
  return std::sqrt(std::max(0.0, all * all - sampling_variance_m2_ - noise_variance_m2_ / (p * p)));
}

void Receiver::report(uint64_t key, float noise_scale, Echoes& echoes) const {
  int kept = 0;
  for (int k = 0; k < echoes.count; ++k) {
    Echo e = echoes.echo[size_t(k)];
    double range = e.range_m;
    if (options_.range_sigma_m > 0) {
      range += jitter_m(double(e.peak), double(noise_scale)) *
               normal(key, kJitter + uint32_t(k), Purpose::kSignal);
    }
    if (range < options_.min_range_m || range > options_.max_range_m) continue;
    double value = e.peak;
    if (options_.intensity == Intensity::kReflectance) {
      value *= range * range / options_.signal_at_1m;
      if (options_.extinction_per_m > 0) value *= std::exp(2 * options_.extinction_per_m * range);
    }
    value = std::min(options_.intensity_scale * value, options_.intensity_most);
    e.intensity = float(rounded(value, options_.intensity_resolution));
    e.range_m = float(rounded(range, options_.range_resolution_m));
    e.width_m = float(rounded(e.width_m, options_.width_resolution_m));
    echoes.echo[size_t(kept++)] = e;
  }
  echoes.count = kept;
  select(options_.mode, options_.max_echoes, echoes);
}

}  // namespace underbrush::radiometry
