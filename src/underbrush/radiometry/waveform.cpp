#include "underbrush/radiometry/waveform.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/clones.hpp"

namespace underbrush::radiometry {
namespace {

/// Quantiles of the standard normal at (k + ½)/4096, scaled to variance 1.
const std::array<float, 4096>& normal_table() {
  static const std::array<float, 4096> table = [] {
    std::array<double, 4096> exact{};
    double square = 0;
    for (size_t k = 0; k < exact.size(); ++k) {
      exact[k] = normal_from_uniform((double(k) + 0.5) / double(exact.size()));
      square += exact[k] * exact[k] / double(exact.size());
    }
    std::array<float, 4096> t{};
    for (size_t k = 0; k < t.size(); ++k) t[k] = float(exact[k] / std::sqrt(square));
    return t;
  }();
  return table;
}

/// What `superpose` adds to.
struct Target {
  const float* rows;
  uint32_t taps;
  double places_per_m;  // Response::kPhases a cell
  float max_range_m;
  std::array<float*, 4> lane;
  uint64_t* blocks;
};

UNDERBRUSH_CLONES void superpose(size_t n, const float* range_m, const float* amplitude,
                                 const Target& t) {
  uint32_t at_word = 0;  // a word of blocks is kept at hand: most returns of a beam lie in one
  uint64_t word = 0;
  for (size_t i = 0; i < n; ++i) {
    const float r = range_m[i], a = amplitude[i];
    if (!(a > 0) || !(r >= 0) || !(r <= t.max_range_m)) continue;
    const auto place = uint32_t(int64_t(double(r) * t.places_per_m));
    const uint32_t at = place / Response::kPhases, phase = place % Response::kPhases;
    const float* __restrict row = t.rows + phase * t.taps;
    float* __restrict to = t.lane[i % 4] + at;
    for (size_t k = 0; k < t.taps; k += 8) {
      for (size_t j = 0; j < 8; ++j) to[k + j] += a * row[k + j];
    }
    const uint32_t first = at / Waveform::kBlock, last = (at + t.taps - 1) / Waveform::kBlock;
    if (first / 64 == at_word && last / 64 == at_word) {
      word |= ((uint64_t(2) << (last - first)) - 1) << first % 64;
      continue;
    }
    for (uint32_t b = first; b <= last; ++b) t.blocks[b / 64] |= uint64_t(1) << b % 64;
    t.blocks[at_word] |= word;
    at_word = first / 64;
    word = 0;
  }
  t.blocks[at_word] |= word;
}

/// Adds the lanes to the first and clears them.
UNDERBRUSH_CLONES void gather(size_t n, float* __restrict sum, float* __restrict a,
                              float* __restrict b, float* __restrict c) {
  for (size_t k = 0; k < n; ++k) {
    sum[k] = (sum[k] + a[k]) + (b[k] + c[k]);
    a[k] = b[k] = c[k] = 0;
  }
}

UNDERBRUSH_CLONES void round_and_cut(float* sample, size_t n, float step, float most) {
  constexpr float kMagic = 12582912;  // 1.5 · 2²³: adding it leaves no place for a fraction
  const float per_step = 1 / step;
  for (size_t k = 0; k < n; ++k) {
    const float v = sample[k] < most ? sample[k] : most;
    sample[k] = step > 0 ? step * ((v * per_step + kMagic) - kMagic) : v;
  }
}

}  // namespace

Waveform::Waveform(const Response& response, double max_range_m)
    : response_(response),
      max_range_m_(max_range_m),
      places_per_m_(Response::kPhases / response.cell_m()) {
  require(std::isfinite(max_range_m) && max_range_m > 0, "waveform: maximum range not positive");
  const double samples = max_range_m / response.cell_m() + response.taps();
  require(samples < 1 << 23, "waveform: too many samples");
  const size_t blocks = size_t(samples) / kBlock + 2;
  sample_.assign(blocks * kBlock, 0);
  lanes_.assign(3 * blocks * kBlock, 0);
  blocks_.assign((blocks + 63) / 64, 0);
}

void Waveform::clear() {
  for_each_run([this](size_t begin, size_t end) {
    std::fill(sample_.begin() + std::ptrdiff_t(begin), sample_.begin() + std::ptrdiff_t(end), 0.0f);
  });
  std::fill(blocks_.begin(), blocks_.end(), 0);
}

void Waveform::add(std::span<const float> range_m, std::span<const float> amplitude) {
  require(range_m.size() == amplitude.size(), "waveform: one amplitude per range is needed");
  superpose(range_m.size(), range_m.data(), amplitude.data(),
            {response_.row(0),
             uint32_t(response_.taps()),
             places_per_m_,
             float(max_range_m_),
             {sample_.data(), lane(1), lane(2), lane(3)},
             blocks_.data()});
  for_each_run([this](size_t begin, size_t end) {
    gather(end - begin, sample_.data() + begin, lane(1) + begin, lane(2) + begin, lane(3) + begin);
  });
}

void Waveform::add_noise(uint64_t key, float sigma) {
  if (!(sigma > 0)) return;
  const auto& normal = normal_table();
  const uint64_t start = random_bits(key, 0, Purpose::kSignal);
  static_assert(kBlock % 4 == 0);
  for_each_run([&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; k += 4) {
      const uint64_t bits = mix64(start + k * 0x9e3779b97f4a7c15ull);
      for (size_t j = 0; j < 4; ++j) sample_[k + j] += sigma * normal[bits >> (16 * j) & 4095];
    }
  });
}

void Waveform::quantise(float step, float most) {
  for_each_run([&](size_t begin, size_t end) {
    round_and_cut(sample_.data() + begin, end - begin, step, most);
  });
}

size_t Waveform::touched() const {
  size_t n = 0;
  for (const uint64_t bits : blocks_) n += size_t(std::popcount(bits));
  return n * kBlock;
}

std::vector<std::pair<double, double>> table_of(const Waveform& waveform) {
  std::vector<std::pair<double, double>> rows;
  waveform.for_each_run([&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      rows.emplace_back(waveform.range_m(double(k)), waveform.samples()[k]);
    }
  });
  return rows;
}

}  // namespace underbrush::radiometry
