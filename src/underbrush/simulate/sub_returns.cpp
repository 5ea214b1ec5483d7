#include "underbrush/simulate/sub_returns.hpp"

#include <cmath>

#include "underbrush/core/clones.hpp"
#include "underbrush/simulate/draw.hpp"

namespace underbrush::simulate {
namespace {

/// Computes `random_bits(key, element, Purpose::kRange)` for numbers in which key, element and
/// purpose are already combined.
UNDERBRUSH_CLONES void mix(size_t n, uint64_t* keys) {
  for (size_t k = 0; k < n; ++k) keys[k] = mix64(mix64(keys[k]) + 0x9e3779b97f4a7c15ull);
}

}  // namespace

void draw_ranges(std::span<const trace::Intersection> met, const trace::RangeLimits& limits,
                 std::span<uint64_t> keys, std::span<float> range_m) {
  static const QuickNormal normal;
  for (size_t k = 0; k < met.size(); ++k) {
    keys[k] ^= uint64_t(Purpose::kRange) << 32 | met[k].element;
  }
  mix(met.size(), keys.data());
  for (size_t k = 0; k < met.size(); ++k) {
    range_m[k] = met[k].none() ? NAN : float(drawn_on_ray(met[k], keys[k], limits, normal));
  }
}

SubReturns::SubReturns(size_t most)
    : sub_ray_(most), range_m_(most), weight_(most), factor_(most), signal_(most) {}

void SubReturns::collect(std::span<const float> range_m, std::span<const float> weight,
                         std::span<const uint32_t> traced) {
  size_t n = 0;
  for (size_t k = 0; k < range_m.size(); ++k) {
    sub_ray_[n] = traced.empty() ? uint32_t(k) : traced[k];
    range_m_[n] = range_m[k];
    weight_[n] = weight[k];
    n += !std::isnan(range_m[k]);
  }
  size_ = n;
}

}  // namespace underbrush::simulate
