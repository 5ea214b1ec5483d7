#include "underbrush/radiometry/detector.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::radiometry {
namespace {

constexpr int kWalkPerOctave = 8, kWalkOctaves = 12;
constexpr int kBiasPlaces = 64;

/// log₂ x for normal x > 0, error below 10⁻⁷.
double log2_of(double x) {
  const uint64_t bits = std::bit_cast<uint64_t>(x);
  const double m = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFull) | 0x3FF0000000000000ull);
  const double z = (m - M_SQRT2) / (m + M_SQRT2), z2 = z * z;
  const double series = z * (1 + z2 * (1.0 / 3 + z2 * (1.0 / 5 + z2 * (1.0 / 7))));
  return double(int(bits >> 52) - 1023) + 0.5 + 2 / M_LN2 * series;
}

/// 2^x for 0 ≤ x ≤ 1, relative error below 10⁻⁶.
double exp2_of(double x) {
  const double y = x * M_LN2;
  return 1 + y * (1 + y / 2 * (1 + y / 3 * (1 + y / 4 * (1 + y / 5 * (1 + y / 6 * (1 + y / 7))))));
}

/// The maximum of a bell through three samples, the middle one highest: exact for a Gaussian.
struct Vertex {
  double place = 0;  // from the middle sample, in samples
  double height = 0;
};
Vertex vertex(double a, double b, double c) {
  if (!(a > 0 && c > 0)) return {0, b};
  a = log2_of(a / b);
  c = log2_of(c / b);
  if (!(a + c < 0)) return {0, b};
  const double place = std::clamp(0.5 * (a - c) / (a + c), -0.5, 0.5);
  return {place, b * exp2_of(std::min(1.0, -0.25 * (a - c) * place))};
}

/// Where between samples k−1 and k the signal passes `level`: linear in its logarithm, as the
/// flanks of a pulse nearly are.
double crossing(const float* s, size_t k, float level) {
  const double a = double(s[k - 1]), b = double(s[k]);
  if (!(a > 0 && b > 0)) return double(k) - (b - double(level)) / (b - a);
  const double to_b = log2_of(b / double(level)), whole = log2_of(b / a);
  return double(k) - (whole == 0 ? 0 : to_b / whole);
}

}  // namespace

void Echoes::push(const Echo& e) {
  if (count == kMost) --count;
  echo[size_t(count++)] = e;
}

/// A pulse under way.
struct Detector::Pulse {
  size_t begin = 0;             // first sample of it
  size_t top = 0, top_end = 0;  // first and last sample of its highest level
  size_t low = 0;               // lowest sample since
  size_t end = 0;               // one past its last sample
  double rise = 0, fall = 0;    // where it passes the threshold, or its valleys
  bool open = false, from_valley = false, to_valley = false;

  static Pulse from(size_t begin, size_t k, double rise) {
    Pulse p;
    p.begin = begin;
    p.top = p.top_end = p.low = k;
    p.rise = rise;
    p.open = true;
    return p;
  }
};

Detector::Detector(const Response& response, const DetectorOptions& options) : options_(options) {
  require(options.threshold > 0 && std::isfinite(options.threshold),
          "detector: the threshold must be positive");
  require(options.valley > 0 && options.valley <= 1, "detector: valley must be in (0, 1]");
  require(options.min_gap_m >= 0, "detector: a negative gap");
  calibrate(response);
}

double Detector::walk_m(double peak, double threshold) const {
  const double at = log2_of(peak / threshold) * kWalkPerOctave;
  const double k = std::clamp(at, 0.0, double(walk_m_.size()) - 1.001);
  return std::lerp(walk_m_[size_t(k)], walk_m_[size_t(k) + 1], k - std::floor(k));
}

double Detector::peak_bias_m(double place) const {
  const double at = std::clamp((place + 0.5) * kBiasPlaces, 0.0, kBiasPlaces - 1e-3);
  return std::lerp(peak_bias_m_[size_t(at)], peak_bias_m_[size_t(at) + 1], at - std::floor(at));
}

void Detector::close(const Waveform& w, const Pulse& p, float threshold, Echoes& echoes) const {
  const float* s = w.samples();
  Vertex top{0.5 * double(p.top_end - p.top), s[p.top]};  // of a saturated pulse: its middle
  if (p.top_end == p.top && p.top > 0 && p.top + 1 < w.size()) {
    top = vertex(s[p.top - 1], s[p.top], s[p.top + 1]);
  }
  Echo e;
  const bool edge = options_.timing == Timing::kLeadingEdge && !p.from_valley;
  e.range_m = float(edge ? w.range_m(p.rise) + walk_m(top.height, threshold)
                         : w.range_m(double(p.top) + top.place) - peak_bias_m(top.place));
  e.peak = float(top.height);
  e.width_m = float((p.fall - p.rise) * w.cell_m());
  // The flanks below the threshold belong to the pulse as long as they fall away from it.
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
      if (e.peak > last.peak) last = e;
      return;
    }
  }
  echoes.push(e);
}

Echoes Detector::detect(const Waveform& w, float threshold) const {
  if (threshold < 0) threshold = options_.threshold;
  const float* s = w.samples();
  Echoes echoes;
  Pulse p;
  w.for_each_run([&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const float v = s[k];
      if (!(v >= threshold)) {
        if (p.open) {
          p.end = k;
          p.fall = crossing(s, k, threshold);
          close(w, p, threshold, echoes);
          p.open = false;
        }
        continue;
      }
      if (!p.open) {
        p = Pulse::from(k, k, k == 0 ? 0 : crossing(s, k, threshold));
        continue;
      }
      // A rise out of a valley that is deep enough on both sides begins the next pulse.
      if (v * options_.valley > s[p.low] && s[p.top] * options_.valley > s[p.low]) {
        p.end = p.low;
        p.fall = double(p.low);
        p.to_valley = true;
        close(w, p, threshold, echoes);
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
    if (p.open) {  // the run ends above the threshold: only at the end of the range
      p.end = end;
      p.fall = double(end);
      close(w, p, threshold, echoes);
      p.open = false;
    }
  });
  return echoes;
}

// What the detector itself makes of noiseless pulses: of the leading edge the mean over the
// target's place in a cell, of the parabola all of them.
void Detector::calibrate(const Response& response) {
  constexpr int kPlaces = 32;
  walk_m_.assign(size_t(kWalkOctaves) * kWalkPerOctave + 1, 0);
  Waveform w(response, 40 * response.cell_m());
  const auto pulse = [&](double place, float peak) {  // the target's range, and the first sample
    const float range = float((20 + place) * response.cell_m());
    w.clear();
    w.add({&range, 1}, {&peak, 1});
    size_t k = 1;
    while (k < w.size() && w.samples()[k] < options_.threshold) ++k;
    return std::pair{double(range), k};
  };
  for (size_t n = 0; n < walk_m_.size(); ++n) {
    const float peak = std::exp2(float(n) / kWalkPerOctave) * options_.threshold;
    int seen = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const auto [range, k] = pulse((i + 0.5) / kPlaces, peak);
      if (k == w.size()) continue;
      walk_m_[n] += range - w.range_m(crossing(w.samples(), k, options_.threshold));
      ++seen;
    }
    if (seen > 0) walk_m_[n] /= seen;
  }
  if (walk_m_[0] == 0) walk_m_[0] = walk_m_[1];  // no sample reached the threshold
  calibrate_peak(response);
}

void Detector::calibrate_peak(const Response& response) {
  Waveform w(response, 40 * response.cell_m());
  std::vector<std::pair<double, double>> bias;  // vertex's place, parabola − target
  for (int i = 0; i < Response::kPhases; ++i) {
    const float range = float((20 + (i + 0.5) / Response::kPhases) * response.cell_m());
    const float peak = 1;
    w.clear();
    w.add({&range, 1}, {&peak, 1});
    const auto k = size_t(std::max_element(w.samples(), w.samples() + w.size()) - w.samples());
    const float* s = w.samples() + k;
    const double place = vertex(s[-1], s[0], s[1]).place;
    bias.emplace_back(place, w.range_m(double(k) + place) - double(range));
  }
  std::sort(bias.begin(), bias.end());
  for (int i = 0; i <= kBiasPlaces; ++i) {
    const double place = double(i) / kBiasPlaces - 0.5;
    const auto above = std::lower_bound(bias.begin(), bias.end(), std::pair{place, -1e9});
    if (above == bias.begin() || above == bias.end()) {
      peak_bias_m_.push_back(above == bias.end() ? bias.back().second : above->second);
      continue;
    }
    const auto below = above - 1;
    const double step = above->first - below->first;
    const double t = step > 0 ? (place - below->first) / step : 0;
    peak_bias_m_.push_back(std::lerp(below->second, above->second, t));
  }
}

}  // namespace underbrush::radiometry
