#include "underbrush/ground/node_mask.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "underbrush/core/parallel.hpp"

namespace underbrush::ground {
namespace {

/// Tells for each node of a block whether it lies within `radius` of a node whose mask is `value`.
std::array<uint8_t, kBlockNodes> near_value(const NodeMask& mask, BlockKey key, double radius,
                                            uint8_t value) {
  const int halo = int(std::floor(radius)), side = kBlockSide + 2 * halo;
  const std::vector<uint8_t> set = window<uint8_t>(mask, key, halo, 0);
  // First the distance to the nearest such node in the same row, then the nearest over all rows.
  const int far = side + 1;
  std::vector<int> along(set.size());
  for (int y = 0; y < side; ++y) {
    int* row = along.data() + ptrdiff_t(y) * side;
    int since = far;
    for (int x = 0; x < side; ++x) {
      since = set[size_t(y * side + x)] == value ? 0 : std::min(far, since + 1);
      row[x] = since;
    }
    since = far;
    for (int x = side; x-- > 0;) {
      since = set[size_t(y * side + x)] == value ? 0 : std::min(far, since + 1);
      row[x] = std::min(row[x], since);
    }
  }
  std::array<uint8_t, kBlockNodes> result{};
  for (int y = 0; y < kBlockSide; ++y) {
    for (int dy = -halo; dy <= halo; ++dy) {
      const double rest = radius * radius - dy * dy;
      const int* row = along.data() + ptrdiff_t(y + halo + dy) * side + halo;
      for (int x = 0; x < kBlockSide; ++x) {
        result[size_t(y * kBlockSide + x)] |= double(row[x]) * row[x] <= rest;
      }
    }
  }
  return result;
}

NodeMask near_values(const NodeMask& mask, const std::vector<BlockKey>& keys, double radius,
                     uint8_t value) {
  std::vector<std::array<uint8_t, kBlockNodes>> blocks(keys.size());
  parallel_for(keys.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) blocks[k] = near_value(mask, keys[k], radius, value);
  });
  NodeMask result;
  for (size_t k = 0; k < keys.size(); ++k) result.emplace_hint(result.end(), keys[k], blocks[k]);
  return result;
}

}  // namespace

template <class T>
std::vector<T> window(const BlockMap<T>& values, int i0, int j0, int side, T absent) {
  std::vector<T> result(size_t(side) * side, absent);
  for (int by = j0 >> 5; by <= (j0 + side - 1) >> 5; ++by) {
    for (int bx = i0 >> 5; bx <= (i0 + side - 1) >> 5; ++bx) {
      const auto block = values.find({by, bx});
      if (block == values.end()) continue;
      const int x0 = std::max(i0, bx * kBlockSide), x1 = std::min(i0 + side, (bx + 1) * kBlockSide);
      const int y0 = std::max(j0, by * kBlockSide), y1 = std::min(j0 + side, (by + 1) * kBlockSide);
      for (int y = y0; y < y1; ++y) {
        std::copy_n(block->second.begin() + place_in_block(x0, y), x1 - x0,
                    result.begin() + ptrdiff_t(y - j0) * side + (x0 - i0));
      }
    }
  }
  return result;
}
template std::vector<uint8_t> window(const BlockMap<uint8_t>&, int, int, int, uint8_t);
template std::vector<int32_t> window(const BlockMap<int32_t>&, int, int, int, int32_t);
template std::vector<double> window(const BlockMap<double>&, int, int, int, double);

NodeMask dilated(const NodeMask& mask, double radius) {
  const int reach = (int(std::floor(radius)) + kBlockSide - 1) / kBlockSide;
  std::vector<BlockKey> keys;
  for (const auto& [key, block] : mask) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) keys.push_back({key.y + y, key.x + x});
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  NodeMask result = near_values(mask, keys, radius, 1);
  std::erase_if(result, [](const auto& block) {
    return std::none_of(block.second.begin(), block.second.end(), [](uint8_t m) { return m; });
  });
  return result;
}

NodeMask eroded(const NodeMask& mask, double radius) {
  std::vector<BlockKey> keys;
  for (const auto& [key, block] : mask) keys.push_back(key);
  NodeMask result = near_values(mask, keys, radius, 0);
  for (auto& [key, block] : result) {
    for (uint8_t& m : block) m = !m;
  }
  return result;
}

NodeMask united(const NodeMask& a, const NodeMask& b) {
  NodeMask result = a;
  for (const auto& [key, block] : b) {
    auto& into = result.try_emplace(key, std::array<uint8_t, kBlockNodes>{}).first->second;
    for (size_t k = 0; k < kBlockNodes; ++k) into[k] |= block[k];
  }
  return result;
}

}  // namespace underbrush::ground
