#include "underbrush/radiometry/response.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::radiometry {
namespace {

constexpr double kCut = 1e-4;
constexpr double kQSwitchedFwhm = 3.3943;  // of x² exp(−x)

double gaussian(double t, double fwhm) { return std::exp(-4 * M_LN2 * t * t / (fwhm * fwhm)); }

double emitted(const ResponseOptions& o, double t) {
  if (o.pulse == Pulse::kGaussian) return gaussian(t, o.pulse_fwhm_s);
  const double x = t * kQSwitchedFwhm / o.pulse_fwhm_s;
  return x > 0 ? x * x * std::exp(-x) : 0;
}

/// Computes the convolution at time t. Two Gaussians have a closed form. Else the trapezium rule is
/// used, which is exact to rounding for smooth functions that vanish at both ends.
double convolved(const ResponseOptions& o, double t) {
  if (o.receiver_fwhm_s == 0) return emitted(o, t);
  if (o.pulse == Pulse::kGaussian) {
    return gaussian(t, std::hypot(o.pulse_fwhm_s, o.receiver_fwhm_s));
  }
  constexpr int kSteps = 200;
  double sum = 0;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const double s = 2.5 * o.receiver_fwhm_s * k / kSteps;
    sum += emitted(o, t - s) * gaussian(s, o.receiver_fwhm_s);
  }
  return sum;
}

/// Finds the maximum of the convolution by golden-section search.
double peak_time(const ResponseOptions& o, double from, double to) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 80; ++k) {
    const double a = to - golden * (to - from), b = from + golden * (to - from);
    (convolved(o, a) < convolved(o, b) ? from : to) = convolved(o, a) < convolved(o, b) ? a : b;
  }
  return 0.5 * (from + to);
}

/// Makes the filter of `Response::noise_filter`.
std::vector<float> noise_taps(const ResponseOptions& o) {
  const double fwhm_s = o.receiver_fwhm_s > 0 ? o.receiver_fwhm_s : o.pulse_fwhm_s;
  const int half = int(1.5 * fwhm_s / o.sample_s);  // it falls to 0.2 % there
  std::vector<double> taps;
  double square = 0;
  for (int k = -half; k <= half; ++k) {
    taps.push_back(gaussian(k * o.sample_s, fwhm_s));
    square += taps.back() * taps.back();
  }
  std::vector<float> filter(taps.size());
  for (size_t k = 0; k < taps.size(); ++k) filter[k] = float(taps[k] / std::sqrt(square));
  return filter;
}

}  // namespace

Response::Response(const ResponseOptions& o) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  require(positive(o.pulse_fwhm_s) && positive(o.sample_s), "response: times must be positive");
  require(std::isfinite(o.receiver_fwhm_s) && o.receiver_fwhm_s >= 0,
          "response: the receiver's time is negative or not finite");
  const double width = std::hypot(o.pulse_fwhm_s, o.receiver_fwhm_s);
  require(width < sensor::kMostSamplesOfPulse * o.sample_s,
          "response: the pulse is longer than 500 samples");
  cell_m_ = kSpeedOfLight * o.sample_s / 2;
  const double peak_s = peak_time(o, -3 * width, 6 * width), peak = convolved(o, peak_s);
  const auto h = [&](double distance_m) {
    return convolved(o, peak_s + 2 * distance_m / kSpeedOfLight) / peak;
  };
  const double width_m = kSpeedOfLight * width / 2;
  step_m_ = std::min(cell_m_, width_m) / 64;
  double low = -step_m_, high = step_m_;
  while (h(low) > kCut && low > -10 * width_m) low -= step_m_;
  while (h(high) > kCut && high < 20 * width_m) high += step_m_;
  first_m_ = low;
  for (double x = low; x <= high + step_m_ / 2; x += step_m_) {
    fine_.push_back(h(x) > kCut ? h(x) : 0);
    area_m_ += fine_.back() * step_m_;
  }
  noise_filter_ = noise_taps(o);
  before_ = int(std::ceil(-low / cell_m_));
  taps_ = (before_ + int(std::ceil(high / cell_m_)) + 2 + 7) / 8 * 8;
  rows_.resize(size_t(kPhases) * size_t(taps_));
  for (int phase = 0; phase < kPhases; ++phase) {
    for (int k = 0; k < taps_; ++k) {
      const double cells = k - before_ - (phase + 0.5) / kPhases;
      rows_[size_t(phase) * size_t(taps_) + size_t(k)] = float(at(cells * cell_m_));
    }
  }
}

double Response::at(double distance_m) const {
  const double x = (distance_m - first_m_) / step_m_;
  if (!(x >= 0) || x >= double(fine_.size() - 1)) return 0;
  const size_t k = size_t(x);
  return fine_[k] + (x - double(k)) * (fine_[k + 1] - fine_[k]);
}

}  // namespace underbrush::radiometry
