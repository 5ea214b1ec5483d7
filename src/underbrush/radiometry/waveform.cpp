#include "underbrush/radiometry/waveform.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/clones.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/radiometry/normal_quantiles.hpp"

namespace underbrush::radiometry {
namespace {

/// The arrays that `superpose` adds to, and what it needs to know about them.
struct Target {
  const float* rows;
  uint32_t taps;
  double places_per_m;  // Response::kPhases a cell
  float max_range_m;
  std::array<float*, 4> lane;
  uint64_t* blocks;
};

/// The number of returns that are placed together.
constexpr size_t kReturns = 64;

/// The places where returns begin, in units of 1/`Response::kPhases` sample. A return that adds
/// nothing has the amplitude 0.
struct Placed {
  uint32_t place[kReturns];
  float amplitude[kReturns];
};

UNDERBRUSH_CLONES void place(size_t n, const float* range_m, const float* amplitude,
                             const Target& t, Placed& out) {
  for (size_t i = 0; i < n; ++i) {
    const float r = range_m[i], a = amplitude[i];
    const bool counts = (a > 0) & (r >= 0) & (r <= t.max_range_m);
    out.amplitude[i] = counts ? a : 0;
    out.place[i] = uint32_t(int32_t(double(counts ? r : 0) * t.places_per_m));
  }
}

uint32_t first_block(uint32_t place) { return place / (Response::kPhases * Waveform::kBlock); }
uint32_t last_block(uint32_t place, uint32_t taps) {
  return (place / Response::kPhases + taps - 1) / Waveform::kBlock;
}

/// The blocks from `first` to `last`, as bits of a word.
uint64_t run_of_blocks(uint64_t first, uint64_t last) {
  return ((uint64_t(2) << (last - first)) - 1) << first;
}

/// The least and the greatest place of the returns that add something; the least is greater if none
/// does.
struct Extent {
  uint32_t least, greatest;
};
UNDERBRUSH_CLONES Extent extent_of(size_t n, const Placed& p) {
  Extent e{UINT32_MAX, 0};
  for (size_t i = 0; i < n; ++i) {
    const uint32_t low = p.amplitude[i] > 0 ? p.place[i] : UINT32_MAX;
    const uint32_t high = p.amplitude[i] > 0 ? p.place[i] : 0;
    e.least = low < e.least ? low : e.least;
    e.greatest = high > e.greatest ? high : e.greatest;
  }
  return e;
}

/// Finds the blocks that returns reach where there are gaps between them.
UNDERBRUSH_CLONES uint64_t reached_apart(size_t n, const Placed& p, uint32_t taps) {
  uint64_t word = 0;
  for (size_t i = 0; i < n; ++i) {
    const uint64_t run = run_of_blocks(first_block(p.place[i]), last_block(p.place[i], taps));
    word |= p.amplitude[i] > 0 ? run : 0;
  }
  return word;
}

/// Finds the blocks that returns reach, for waveforms with at most a word of blocks.
uint64_t reached(size_t n, const Placed& p, uint32_t taps) {
  // A few returns far from each other show that there may be gaps, so that not all are compared.
  const auto [low, high] =
      std::minmax({p.place[0], p.place[n / 3], p.place[2 * n / 3], p.place[n - 1]});
  if (first_block(high) > last_block(low, taps) + 1) return reached_apart(n, p, taps);
  const Extent e = extent_of(n, p);
  if (e.least > e.greatest) return 0;
  if (first_block(e.greatest) <= last_block(e.least, taps) + 1) {  // one run without gaps
    return run_of_blocks(first_block(e.least), last_block(e.greatest, taps));
  }
  return reached_apart(n, p, taps);
}

void mark(size_t n, const Placed& p, const Target& t) {
  for (size_t i = 0; i < n; ++i) {
    if (p.amplitude[i] == 0) continue;
    const uint32_t last = last_block(p.place[i], t.taps);
    for (uint32_t b = first_block(p.place[i]); b <= last; ++b) {
      t.blocks[b / 64] |= uint64_t(1) << b % 64;
    }
  }
}

/// Eight samples anywhere in memory. Clang forgets `aligned` in a declaration with `using`.
typedef float Eight __attribute__((vector_size(32), aligned(4), may_alias));  // NOLINT

/// Adds returns to the lanes. The most frequent numbers of taps are template arguments, so that the
/// inner loop needs no branch.
template <uint32_t kTaps>
[[gnu::always_inline]] inline void add_rows(size_t n, const Placed& p, const Target& t) {
  const uint32_t taps = kTaps > 0 ? kTaps : t.taps;
  for (size_t i = 0; i < n; ++i) {
    const uint32_t at = p.place[i] / Response::kPhases, phase = p.place[i] % Response::kPhases;
    const float a = p.amplitude[i];
    // NOLINTBEGIN(modernize-use-auto): `auto` forgets that the samples lie anywhere.
    const Eight* row = reinterpret_cast<const Eight*>(t.rows + phase * taps);
    Eight* to = reinterpret_cast<Eight*>(t.lane[i % 4] + at);
    // NOLINTEND(modernize-use-auto)
    for (size_t k = 0; k < taps / 8; ++k) to[k] += a * row[k];
  }
}

UNDERBRUSH_CLONES void superpose(size_t n, const Placed& p, const Target& t) {
  t.taps == 16   ? add_rows<16>(n, p, t)
  : t.taps == 24 ? add_rows<24>(n, p, t)
                 : add_rows<0>(n, p, t);
}

/// Adds all lanes to the first one and clears them.
UNDERBRUSH_CLONES void gather(size_t n, float* __restrict sum, float* __restrict a,
                              float* __restrict b, float* __restrict c) {
  for (size_t k = 0; k < n; ++k) {
    sum[k] = (sum[k] + a[k]) + (b[k] + c[k]);
    a[k] = b[k] = c[k] = 0;
  }
}

/// Adds the convolution of the white noise with the filter.
UNDERBRUSH_CLONES void add_filtered(size_t n, const float* __restrict white, size_t taps,
                                    const float* __restrict filter, float* __restrict sample) {
  for (size_t j = 0; j < taps; ++j) {
    for (size_t k = 0; k < n; ++k) sample[k] += filter[j] * white[k + j];
  }
}

UNDERBRUSH_CLONES void round_and_cut(float* sample, size_t n, float step, float most) {
  constexpr float kMagic = 12582912;  // 1.5 · 2²³: adding it leaves no bits for a fraction
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
  require_data(samples < 1 << 23, "waveform: too many samples");
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
  const Target target{response_.row(0),
                      uint32_t(response_.taps()),
                      places_per_m_,
                      float(max_range_m_),
                      {sample_.data(), lane(1), lane(2), lane(3)},
                      blocks_.data()};
  Placed placed;
  for (size_t first = 0; first < range_m.size(); first += kReturns) {
    const size_t n = std::min(kReturns, range_m.size() - first);
    place(n, range_m.data() + first, amplitude.data() + first, target, placed);
    if (blocks_.size() == 1) {
      blocks_[0] |= reached(n, placed, target.taps);
    } else {
      mark(n, placed, target);
    }
    superpose(n, placed, target);
  }
  for_each_run([this](size_t begin, size_t end) {
    gather(end - begin, sample_.data() + begin, lane(1) + begin, lane(2) + begin, lane(3) + begin);
  });
}

void Waveform::add_noise(uint64_t key, float sigma) {
  if (!(sigma > 0)) return;
  const auto& normal = normal_quantiles();
  const uint64_t start = random_bits(key, 0, Purpose::kSignal);
  const std::span<const float> filter = response_.noise_filter();
  static_assert(kBlock % 4 == 0);
  for_each_run([&](size_t begin, size_t end) {
    // White noise k belongs to sample k − filter.size() / 2, so that numbers begin at 0.
    const size_t needed = end - begin + filter.size() - 1;
    white_.resize((needed + 3) / 4 * 4);
    for (size_t k = 0; k < white_.size(); k += 4) {
      const uint64_t bits = mix64(start + (begin + k) * 0x9e3779b97f4a7c15ull);
      for (size_t j = 0; j < 4; ++j) white_[k + j] = sigma * normal[bits >> (16 * j) & 4095];
    }
    add_filtered(end - begin, white_.data(), filter.size(), filter.data(), &sample_[begin]);
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

size_t Waveform::reach_of(float range_m) const {
  const auto place = uint32_t(int32_t(double(range_m) * places_per_m_));
  return (last_block(place, uint32_t(response_.taps())) - first_block(place) + 1) * kBlock;
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
