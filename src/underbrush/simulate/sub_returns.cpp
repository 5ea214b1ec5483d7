#include "underbrush/simulate/sub_returns.hpp"

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

SubReturns::SubReturns(size_t most)
    : sub_ray_(most), range_m_(most), weight_(most), factor_(most), signal_(most), bits_(most) {}

void SubReturns::collect(std::span<const trace::Intersection> met, std::span<const uint64_t> keys,
                         std::span<const float> weight, const trace::RangeLimits& limits) {
  size_t n = 0;
  for (size_t k = 0; k < met.size(); ++k) {
    sub_ray_[n] = uint32_t(k);
    weight_[n] = weight[k];
    bits_[n] = keys[k] ^ (uint64_t(Purpose::kRange) << 32 | met[k].element);
    n += !met[k].none();
  }
  size_ = n;
  mix(n, bits_.data());
  for (size_t k = 0; k < n; ++k) {
    const trace::Intersection& m = met[sub_ray_[k]];
    range_m_[k] = float(drawn_on_ray(m, bits_[k], limits, normal_));
  }
}

}  // namespace underbrush::simulate
