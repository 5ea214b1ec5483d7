#include "underbrush/radiometry/pulse_timing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace underbrush::radiometry {
namespace {

constexpr int kWalkPerOctave = 8, kWalkOctaves = 12;
constexpr int kBiasPlaces = 64;
constexpr double kFraction = 0.5;  // of the peak: flanks are steep there and clear of noise

/// Computes log₂ x for normal x > 0 with an error below 10⁻⁷.
double log2_of(double x) {
  const uint64_t bits = std::bit_cast<uint64_t>(x);
  const double m = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFull) | 0x3FF0000000000000ull);
  const double z = (m - M_SQRT2) / (m + M_SQRT2), z2 = z * z;
  const double series = z * (1 + z2 * (1.0 / 3 + z2 * (1.0 / 5 + z2 * (1.0 / 7))));
  return double(int(bits >> 52) - 1023) + 0.5 + 2 / M_LN2 * series;
}

/// Computes 2^x for 0 ≤ x ≤ 1 with a relative error below 10⁻⁶.
double exp2_of(double x) {
  const double y = x * M_LN2;
  return 1 + y * (1 + y / 2 * (1 + y / 3 * (1 + y / 4 * (1 + y / 5 * (1 + y / 6 * (1 + y / 7))))));
}

/// The maximum of a bell curve through three samples, of which the middle one is the highest. It is
/// exact for a Gaussian.
struct Vertex {
  double place = 0;  // in samples from the middle one
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

/// Fills the waveform with the noiseless return of a target at `range_m` behind the waveform's
/// start.
void send(Waveform& w, float range_m, float peak) {
  w.clear();
  w.add({&range_m, 1}, {&peak, 1});
}

/// Finds x where h(x) / h(x + width) = a / b. It is negative: the front's sample lies before the
/// target.
double front_place_m(const Response& h, double width_m, double a, double b) {
  double low = -width_m, high = 0;
  for (int k = 0; k < 30; ++k) {
    const double x = 0.5 * (low + high);
    (h.at(x) * b < a * h.at(x + width_m) ? low : high) = x;
  }
  return 0.5 * (low + high);
}

}  // namespace

PulseTiming::PulseTiming(const Response& response, Timing timing, float threshold, float saturation)
    : timing_(timing),
      saturation_(saturation),
      walk_m_(timing == Timing::kLeadingEdge ? walk_table(response, threshold) : Table{}),
      peak_bias_m_(bias_table(response, Timing::kPeak)),
      half_bias_m_(timing == Timing::kConstantFraction ? bias_table(response, timing) : Table{}) {}

double PulseTiming::crossing(const float* s, size_t k, double level) {
  const double a = double(s[k - 1]), b = double(s[k]);
  if (!(a > 0 && b > 0)) return double(k) - (b - level) / (b - a);
  const double to_b = log2_of(b / level), whole = log2_of(b / a);
  return double(k) - (whole == 0 ? 0 : to_b / whole);
}

double PulseTiming::look_up(const Table& table, double part) {
  const double at = std::clamp(part * kBiasPlaces, 0.0, kBiasPlaces - 1e-3);
  return std::lerp(table[size_t(at)], table[size_t(at) + 1], at - std::floor(at));
}

double PulseTiming::walk_m(double peak, double threshold) const {
  const double at = log2_of(peak / threshold) * kWalkPerOctave;
  const double k = std::clamp(at, 0.0, double(walk_m_.size()) - 1.001);
  return std::lerp(walk_m_[size_t(k)], walk_m_[size_t(k) + 1], k - std::floor(k));
}

bool PulseTiming::half_height(const float* s, const PulseSpan& pulse, double height, Place& place) {
  const double level = kFraction * height;
  size_t k = pulse.top;
  while (k > 0 && double(s[k - 1]) >= level) --k;
  if (k == 0 || (pulse.from_valley && k <= pulse.begin)) return false;
  place.at = crossing(s, k, level);
  place.part = place.at - double(k - 1);
  return true;
}

PulseTime PulseTiming::time(const Waveform& w, const PulseSpan& pulse, double threshold) const {
  const float* s = w.samples();
  const bool inside = pulse.top > 0 && pulse.top_end + 1 < w.size();
  if (s[pulse.top] >= saturation_ && inside) {
    return {saturated_m(w, pulse, threshold), double(s[pulse.top])};
  }
  Vertex top{0.5 * double(pulse.top_end - pulse.top), double(s[pulse.top])};
  if (pulse.top_end == pulse.top && inside) {
    top = vertex(s[pulse.top - 1], s[pulse.top], s[pulse.top + 1]);
  }
  Place half;
  if (timing_ == Timing::kLeadingEdge && !pulse.from_valley) {
    return {w.range_m(pulse.rise) + walk_m(top.height, threshold), top.height};
  }
  if (timing_ == Timing::kConstantFraction && half_height(s, pulse, top.height, half)) {
    return {w.range_m(half.at) - look_up(half_bias_m_, half.part), top.height};
  }
  const double bias = look_up(peak_bias_m_, top.place + 0.5);
  return {w.range_m(double(pulse.top) + top.place) - bias, top.height};
}

double PulseTiming::saturated_m(const Waveform& w, const PulseSpan& pulse, double threshold) const {
  const float* s = w.samples();
  const double most = double(s[pulse.top]);
  struct Sample {
    size_t at;
    double level;
  };
  const auto bounds = [&](size_t outside, size_t on) -> std::array<Sample, 2> {
    const double level = double(s[outside]);
    if (level >= threshold) return {Sample{outside, level}, Sample{outside, level}};
    return {Sample{outside, threshold}, Sample{on, most}};
  };
  double sum = 0;
  for (const Sample& a : bounds(pulse.top - 1, pulse.top)) {
    for (const Sample& b : bounds(pulse.top_end + 1, pulse.top_end)) {
      const double width = double(b.at - a.at) * w.cell_m();
      sum += w.range_m(double(a.at)) - front_place_m(w.response(), width, a.level, b.level);
    }
  }
  return sum / 4;
}

// Tabulates the error of the leading edge for noiseless pulses, as the mean over places of the
// target in a cell.
PulseTiming::Table PulseTiming::walk_table(const Response& response, float threshold) {
  constexpr int kPlaces = 32;
  Table walk(size_t(kWalkOctaves) * kWalkPerOctave + 1, 0);
  Waveform w(response, 40 * response.cell_m());
  for (size_t n = 0; n < walk.size(); ++n) {
    const float peak = std::exp2(float(n) / kWalkPerOctave) * threshold;
    int seen = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const float range = float((20 + (i + 0.5) / kPlaces) * response.cell_m());
      send(w, range, peak);
      size_t k = 1;
      while (k < w.size() && w.samples()[k] < threshold) ++k;
      if (k == w.size()) continue;
      walk[n] += double(range) - w.range_m(crossing(w.samples(), k, threshold));
      ++seen;
    }
    if (seen > 0) walk[n] /= seen;
  }
  if (walk[0] == 0) walk[0] = walk[1];  // no sample reached the threshold
  return walk;
}

PulseTiming::Table PulseTiming::bias_table(const Response& response, Timing timing) {
  Waveform w(response, 40 * response.cell_m());
  std::vector<std::pair<double, double>> bias;  // part of a sample, found − target
  for (int i = 0; i < Response::kPhases; ++i) {
    const float range = float((20 + (i + 0.5) / Response::kPhases) * response.cell_m());
    send(w, range, 1);
    PulseSpan pulse;
    pulse.top = size_t(std::max_element(w.samples(), w.samples() + w.size()) - w.samples());
    const float* s = w.samples() + pulse.top;
    const Vertex top = vertex(s[-1], s[0], s[1]);
    Place place{double(pulse.top) + top.place, top.place + 0.5};
    if (timing == Timing::kConstantFraction) half_height(w.samples(), pulse, top.height, place);
    bias.emplace_back(place.part, w.range_m(place.at) - double(range));
  }
  std::sort(bias.begin(), bias.end());
  Table table;
  for (int i = 0; i <= kBiasPlaces; ++i) {
    const double part = double(i) / kBiasPlaces;
    const auto above = std::lower_bound(bias.begin(), bias.end(), std::pair{part, -1e9});
    if (above == bias.begin() || above == bias.end()) {
      table.push_back(above == bias.end() ? bias.back().second : above->second);
      continue;
    }
    const auto below = above - 1;
    const double step = above->first - below->first;
    const double t = step > 0 ? (part - below->first) / step : 0;
    table.push_back(std::lerp(below->second, above->second, t));
  }
  return table;
}

}  // namespace underbrush::radiometry
