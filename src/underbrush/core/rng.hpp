/// \file
/// Stateless random numbers: each is a hash of its key, element and purpose. The same seed gives
/// the same bits for any order of evaluation, any number of threads and any machine.
#pragma once
#include <cstdint>

namespace underbrush {

/// The purpose of a random number. Numbers drawn for different purposes are independent.
enum class Purpose : uint32_t {
  kAccept,
  kRange,
  kDirection,
  kNoise,
  kCluster,
  kSplit,
  kPlace,
  kSignal,
  kKeyframe,
  kUnknown
};

/// Mixes 64 bits with full avalanche (the finaliser of splitmix64).
constexpr uint64_t mix64(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Returns the key of all random numbers of one beam, from the run's seed and the beam's scan and
/// number.
constexpr uint64_t beam_key(uint64_t seed, uint64_t scan, uint64_t beam) {
  constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ull;
  uint64_t h = mix64(seed + kGolden);
  h = mix64(h ^ (scan + kGolden));
  return mix64(h ^ (beam + kGolden));
}

/// Returns the 32 random bits that decide whether a beam accepts an element with probability p: it
/// does iff bits < p·2³². Three multiplications are needed; with fewer the bits fail a χ² test of
/// independence.
constexpr uint32_t accept_bits(uint64_t key, uint32_t element) {
  uint32_t x = element ^ uint32_t(key);
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = ((x ^ (x >> 15)) + uint32_t(key >> 32)) * 0x846ca68bu;
  x = (x ^ (x >> 16)) * 0x9e3779b1u;
  return x ^ (x >> 15);
}

/// Returns 64 random bits for (key, element, purpose).
constexpr uint64_t random_bits(uint64_t key, uint32_t element, Purpose purpose) {
  return mix64(mix64(key ^ (uint64_t(purpose) << 32 | element)) + 0x9e3779b97f4a7c15ull);
}

/// Turns random bits into a uniform number in the open interval (0, 1).
constexpr double uniform_from_bits(uint64_t bits) { return (double(bits >> 12) + 0.5) * 0x1p-52; }

/// Turns a uniform number in (0, 1) into a standard normal one by Wichura's AS 241 (PPND16), with a
/// relative error below 1e-15.
double normal_from_uniform(double u);

/// Approximates `normal_from_uniform(uniform_from_bits(bits))` several times faster. It
/// interpolates linearly between quantiles 1/4096 apart, with an error below 2e-4; in the tails
/// (1/256 on either side) it is exact.
class QuickNormal {
 public:
  QuickNormal();
  double operator()(uint64_t bits) const {
    const uint64_t k = bits >> 52;
    if (k - kTail >= kSteps - 2 * kTail) return normal_from_uniform(uniform_from_bits(bits));
    const double within = double(bits & ((uint64_t(1) << 52) - 1)) * 0x1p-52;
    return quantile_[k] + within * (quantile_[k + 1] - quantile_[k]);
  }

 private:
  static constexpr uint64_t kSteps = 4096, kTail = kSteps / 256;
  const double* quantile_;  ///< Quantiles at k / kSteps; entries 0 and kSteps are not used.
};

/// Returns a standard normal number for (key, element, purpose).
inline double normal(uint64_t key, uint32_t element, Purpose purpose) {
  return normal_from_uniform(uniform_from_bits(random_bits(key, element, purpose)));
}

/// Sequence of random numbers, for generators and tests that need many in a row. It is
/// counter-based: a copy yields the same numbers as the original.
class Stream {
 public:
  explicit constexpr Stream(uint64_t seed) : key_(mix64(seed + 0x9e3779b97f4a7c15ull)) {}
  constexpr uint64_t bits() { return mix64(key_ + 0x9e3779b97f4a7c15ull * ++count_); }
  constexpr double uniform() { return uniform_from_bits(bits()); }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() { return normal_from_uniform(uniform()); }
  /// Returns a uniform integer in [0, n); n > 0.
  constexpr uint64_t below(uint64_t n) {
    __extension__ using Wide = unsigned __int128;
    return uint64_t((static_cast<Wide>(bits()) * n) >> 64);
  }

 private:
  uint64_t key_, count_ = 0;
};

}  // namespace underbrush
