#include "underbrush/trace/order.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace underbrush::trace {
namespace {

constexpr int kAxisBits = 9, kKeyBits = 2 * kAxisBits, kIndexBits = 14;
static_assert(kOrdered <= size_t(1) << kIndexBits && kKeyBits + kIndexBits <= 32);

/// The bits of x apart from each other: x in the even places.
constexpr uint32_t spread(uint32_t x) {
  x = (x | x << 8) & 0x00ff00ff;
  x = (x | x << 4) & 0x0f0f0f0f;
  x = (x | x << 2) & 0x33333333;
  return (x | x << 1) & 0x55555555;
}

/// The sphere unfolded onto a square by the octahedron, cells along Morton's curve.
uint32_t direction_key(const Vec3& d) {
  const float scale = 1 / float(std::abs(d.x()) + std::abs(d.y()) + std::abs(d.z()));
  float u = float(d.x()) * scale, v = float(d.y()) * scale;
  if (d.z() < 0) {
    const float folded = std::copysign(1 - std::abs(v), u);
    v = std::copysign(1 - std::abs(u), v);
    u = folded;
  }
  constexpr float kHalf = float(1 << (kAxisBits - 1)) * 0.9999f;
  return spread(uint32_t((u + 1) * kHalf)) | spread(uint32_t((v + 1) * kHalf)) << 1;
}

}  // namespace

void order_by_direction(std::span<const Ray> rays, std::span<uint32_t> order,
                        std::span<uint32_t> scratch) {
  constexpr uint32_t kIndexMask = (1u << kIndexBits) - 1, kDigit = 1u << kAxisBits;
  std::array<uint32_t, kDigit> low{}, high{};
  for (uint32_t i = 0; i < rays.size(); ++i) {
    const uint32_t key = direction_key(rays[i].direction);
    ++low[key & (kDigit - 1)];
    ++high[key >> kAxisBits];
    order[i] = key << kIndexBits | i;
  }
  for (auto* count : {&low, &high}) {
    uint32_t sum = 0;
    for (uint32_t& c : *count) sum += std::exchange(c, sum);
  }
  for (const uint32_t x : order) scratch[low[x >> kIndexBits & (kDigit - 1)]++] = x;
  for (const uint32_t x : scratch) {
    order[high[x >> (kIndexBits + kAxisBits)]++] = x & kIndexMask;
  }
}

}  // namespace underbrush::trace
