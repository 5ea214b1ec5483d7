#include "underbrush/trace/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace underbrush::trace {
namespace {

constexpr uint32_t kAzimuthBins = 1024, kElevationBins = 512;
constexpr uint32_t kStrips = 4;
static_assert(kOrdered <= 1u << 13);

float scale_of(float low, float high, uint32_t bins) {
  return high > low ? float(bins) * 0.9999f / (high - low) : 0;
}

template <size_t kSize>
float occupied(const std::array<uint32_t, kSize>& count) {
  return float(kSize - size_t(std::count(count.begin(), count.end(), 0u)));
}

}  // namespace

// As an R-tree is packed: bands of elevation that hold as many rays each, so many that the runs of
// `together` rays along a band's azimuth come out about as wide as high.
void order_by_direction(const Unfolded& rays, std::span<uint32_t> order, size_t together) {
  const uint32_t n = uint32_t(order.size());
  const float to_column = scale_of(rays.turn_low, rays.turn_high, kAzimuthBins);
  const float to_row = scale_of(rays.up_low, rays.up_high, kElevationBins);
  std::array<uint32_t, kAzimuthBins> columns{};
  std::array<uint32_t, kElevationBins> rows{};
  std::array<uint32_t, kOrdered> cell, by_column;
  for (uint32_t i = 0; i < n; ++i) {
    const int column = int((rays.turn[i] - rays.turn_low) * to_column);
    const int row = int((rays.up[i] - rays.up_low) * to_row);
    cell[i] = uint32_t(row << 16 | column);
  }
  for (uint32_t i = 0; i < n; ++i) {
    ++columns[cell[i] & 0xffff];
    ++rows[cell[i] >> 16];
  }
  // A quarter turn is 1 in `turn` and π/2 in angle; elevation counts as its sine.
  const float width = to_column > 0 ? occupied(columns) / to_column * float(M_PI / 2) : 1e-6f;
  const float height = to_row > 0 ? occupied(rows) / to_row : 1e-6f;
  const float tiles = std::max(1.0f, float(n) / float(together));
  const float bands = std::clamp(std::round(std::sqrt(tiles * height / width)), 1.0f, tiles);
  // Rows to strips, kStrips a band; then sorted by column within the band.
  std::array<uint32_t, kElevationBins> strip_of_row;
  std::array<uint32_t, kOrdered / 64 + 1> band_at{};
  uint32_t below = 0;
  for (size_t r = 0; r < kElevationBins; ++r) {
    const float middle = float(below) + 0.5f * float(rows[r]);
    strip_of_row[r] = uint32_t(middle * bands * kStrips / float(n) * 0.9999f);
    band_at[strip_of_row[r] / kStrips] += rows[r];
    below += rows[r];
  }
  const auto to_starts = [](auto& count) {
    uint32_t sum = 0;
    for (uint32_t& c : count) sum += std::exchange(c, sum);
  };
  to_starts(columns);
  to_starts(band_at);
  for (uint32_t i = 0; i < n; ++i) {
    by_column[columns[cell[i] & 0xffff]++] = strip_of_row[cell[i] >> 16] << 13 | i;
  }
  std::array<uint32_t, kOrdered>& by_band = cell;
  for (uint32_t k = 0; k < n; ++k) {
    by_band[band_at[(by_column[k] >> 13) / kStrips]++] = by_column[k];
  }
  // Within each tile by strip, so that the rays of one vector are a compact tile too.
  for (size_t tile = 0; tile < n; tile += together) {
    const size_t end = std::min<size_t>(n, tile + together);
    std::array<uint32_t, kStrips> at{};
    for (size_t k = tile; k < end; ++k) ++at[(by_band[k] >> 13) % kStrips];
    to_starts(at);
    for (size_t k = tile; k < end; ++k) {
      order[tile + at[(by_band[k] >> 13) % kStrips]++] = by_band[k] & (kOrdered - 1);
    }
  }
}

}  // namespace underbrush::trace
