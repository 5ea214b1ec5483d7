#include "underbrush/radiometry/detector.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::radiometry {
namespace {

constexpr float kRelease = 3, kDepth = 5;  // in standard deviations of the noise

/// Finds the first of the samples [k, end) that is not below the threshold, or gives `end`.
size_t first_above(const float* s, size_t k, size_t end, float threshold) {
  typedef float Eight __attribute__((vector_size(32), aligned(4), may_alias));  // NOLINT
  using Words = int64_t __attribute__((vector_size(32)));
  for (; k + 8 <= end; k += 8) {
    const Words below = (Words)(*reinterpret_cast<const Eight*>(s + k) < threshold);
    if ((below[0] & below[1] & below[2] & below[3]) != -1) break;
  }
  while (k < end && s[k] < threshold) ++k;
  return k;
}

}  // namespace

void Echoes::push(const Echo& e) {
  if (count == kMost) --count;
  echo[size_t(count++)] = e;
}

/// A pulse that is being followed.
struct Detector::Pulse : PulseSpan {
  size_t low = 0;   // lowest sample since its top
  size_t end = 0;   // one past its last sample
  double fall = 0;  // where it passes the threshold, or where its valley is
  bool open = false, to_valley = false;
  bool under = false;  // whether the signal is below the threshold, but not by enough to end it

  static Pulse from(size_t begin, size_t k, double rise) {
    Pulse p;
    p.begin = begin;
    p.top = p.top_end = p.low = k;
    p.rise = rise;
    p.open = true;
    return p;
  }
};

void DetectorOptions::check() const {
  require(threshold > 0 && std::isfinite(threshold), "detector: the threshold must be positive");
  require(valley > 0 && valley <= 1, "detector: valley must be in (0, 1]");
  require(min_gap_m >= 0, "detector: a negative gap");
  require(saturation > 0, "detector: saturation must be positive");
}

Detector::Detector(const Response& response, const DetectorOptions& options)
    : options_((options.check(), options)),
      timing_(response, options.timing, options.threshold, options.saturation) {}

void Detector::close(const Waveform& w, const Pulse& p, float threshold, double& joined,
                     Echoes& echoes) const {
  const float* s = w.samples();
  const PulseTime at = timing_.time(w, p, threshold);
  Echo e;
  e.range_m = float(at.range_m);
  e.peak = float(at.height);
  e.width_m = float((p.fall - p.rise) * w.cell_m());
  // A flank below the threshold belongs to the pulse for as long as it falls away from it.
  size_t begin = p.begin, end = p.end;
  if (!p.from_valley) {
    while (begin > 0 && s[begin - 1] > 0 && s[begin - 1] < s[begin]) --begin;
  }
  if (!p.to_valley) {
    while (end < w.size() && s[end] > 0 && s[end] < s[end - 1]) ++end;
  }
  double sum = 0;
  for (size_t k = begin; k < end; ++k) sum += double(s[k]);
  e.energy = float(sum * w.cell_m() / w.response().area_m());
  if (echoes.count > 0) {
    Echo& last = echoes.echo[size_t(echoes.count) - 1];
    if (e.range_m - last.range_m < options_.min_gap_m) {
      const float width = float(p.fall * w.cell_m() - joined), energy = last.energy + e.energy;
      if (e.peak > last.peak) last = e;
      last.width_m = width;
      last.energy = energy;
      return;
    }
  }
  joined = p.rise * w.cell_m();
  echoes.push(e);
}

bool Detector::is_valley(float low, float peak, float noise) const {
  return peak * options_.valley > low && peak - low > kDepth * noise;
}

Echoes Detector::detect(const Waveform& w, float scale) const {
  const float threshold = options_.threshold * scale, noise = options_.noise * scale;
  const float* s = w.samples();
  const float release = threshold - kRelease * noise;
  Echoes echoes;
  Pulse p;
  double joined = 0;  // where the last echo's pulse begins, m
  const auto finish = [&] {
    close(w, p, threshold, joined, echoes);
    p.open = false;
  };
  w.for_each_run([&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      if (!p.open && (k = first_above(s, k, end, threshold)) == end) break;
      const float v = s[k];
      if (v < threshold) {
        if (!p.under) {
          p.end = k;
          p.fall = PulseTiming::crossing(s, k, threshold);
          p.under = true;
        }
        if (v < release || noise == 0) {
          finish();
        } else if (v < s[p.low]) {
          p.low = k;
        }
        continue;
      }
      if (!p.open) {
        p = Pulse::from(k, k, k == 0 ? 0 : PulseTiming::crossing(s, k, threshold));
        continue;
      }
      p.under = false;
      // A rise out of a valley that is deep enough on both sides begins a new pulse.
      if (is_valley(s[p.low], std::min(v, s[p.top]), noise)) {
        p.end = p.low;
        p.fall = double(p.low);
        p.to_valley = true;
        finish();
        p = Pulse::from(p.low, k, double(p.low));
        p.from_valley = true;
        continue;
      }
      if (v > s[p.top]) {
        p.top = p.top_end = p.low = k;
      } else if (v == s[p.top] && p.top_end + 1 == k) {
        p.top_end = p.low = k;
      } else if (v < s[p.low]) {
        p.low = k;
      }
    }
    if (!p.open) return;
    if (!p.under) {  // the signal is above the threshold at the end of the range
      p.end = end;
      p.fall = double(end);
    }
    finish();
  });
  return echoes;
}

}  // namespace underbrush::radiometry
