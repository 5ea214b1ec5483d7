#include "underbrush/trace/order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace underbrush::trace {
namespace {

constexpr uint32_t kAzimuthBins = 1024, kElevationBins = 512;
constexpr uint32_t kStrips = 4;
constexpr size_t kMostBands = kBatchRays / kPacketRays + 1;
constexpr float kBunch = 0.5f;  // reach of a bunch, in sides of a tile
constexpr uint32_t kLong = 7;
constexpr size_t kLooked = 512;  // rays that are compared at a time with those before
constexpr float kSlack = 0.25f;  // of a tile's side, by which repeated directions may differ
static_assert(std::has_single_bit(kBatchRays) && kBatchRays <= 1u << 13);

float scale_of(float low, float high, uint32_t bins) {
  return high > low ? float(bins) * 0.9999f / (high - low) : 0;
}

template <size_t kSize>
float occupied(const std::array<uint32_t, kSize>& count) {
  return float(kSize - size_t(std::count(count.begin(), count.end(), 0u)));
}

// The items that are put in order: rays or, where consecutive rays point alike, bunches of them.
struct Items {
  uint32_t count;
  bool bunched;
  std::array<uint32_t, kBatchRays + 1> first;  // first ray of each bunch
};

// Decides whether rays come in bunches: many must lie within `turn` and `up` of the ray kLong
// before them. If so, cuts them into bunches that reach as far from their first ray.
void bunch(const FloatRays& rays, uint32_t n, float turn, float up, Items& items) {
  const auto alike = [&](uint32_t i, uint32_t j) {
    return (std::abs(rays.azimuth[i] - rays.azimuth[j]) < turn) &
           (std::abs(rays.sin_elevation[i] - rays.sin_elevation[j]) < up);
  };
  uint32_t close = 0, looked_at = 0;
  for (uint32_t i = kLong; i < n; i += 37, ++looked_at) close += alike(i, i - kLong);
  items.bunched = 5 * close > 2 * looked_at;
  items.count = items.bunched ? 0 : n;
  for (uint32_t i = 0, first = n; items.bunched && i < n; ++i) {
    if (first < n && alike(i, first)) continue;
    items.first[items.count++] = first = i;
  }
  items.first[items.count] = n;
}

using Rows = std::array<uint32_t, kElevationBins>;

template <class Counts>
void to_starts(Counts& count) {
  uint32_t sum = 0;
  for (uint32_t& c : count) sum += std::exchange(c, sum);
}

// Assigns each row of elevation to a strip, so that all bands hold equally many rays.
void cut(const Rows& rows, float bands, uint32_t n, Rows& strip) {
  uint32_t below = 0;
  for (size_t r = 0; r < kElevationBins; ++r) {
    const float middle = float(below) + 0.5f * float(rows[r]);
    strip[r] = uint32_t(middle * bands * kStrips / float(n) * 0.9999f);
    below += rows[r];
  }
}

// Sorts the rays within each tile by strip, so that the rays of one vector form a compact tile,
// too.
void sort_tiles(std::span<const uint32_t> by_band, std::span<uint32_t> order) {
  for (size_t tile = 0; tile < order.size(); tile += kPacketRays) {
    const size_t end = std::min(order.size(), tile + kPacketRays);
    std::array<uint32_t, kStrips> at{};
    for (size_t k = tile; k < end; ++k) ++at[(by_band[k] >> 13) % kStrips];
    to_starts(at);
    for (size_t k = tile; k < end; ++k) {
      order[tile + at[(by_band[k] >> 13) % kStrips]++] = by_band[k] & (kBatchRays - 1);
    }
  }
}

}  // namespace

// Packs the directions as a packed R-tree does: it makes bands of elevation with equally many rays
// each. The number of bands is such that runs of kPacketRays rays along a band's azimuth are about
// as wide as high.
float order_by_direction(const FloatRays& rays, std::span<uint32_t> order) {
  const uint32_t n = uint32_t(order.size());
  const float to_column = scale_of(rays.azimuth_low, rays.azimuth_high, kAzimuthBins);
  const float to_row = scale_of(rays.sin_elevation_low, rays.sin_elevation_high, kElevationBins);
  std::array<uint32_t, kAzimuthBins> columns{};
  std::array<uint32_t, kMostBands> of_band{};
  Rows rows{}, strip_of_row;
  std::array<uint32_t, kBatchRays> cell, by_column;
  for (uint32_t i = 0; i < n; ++i) {
    const int column = int((rays.azimuth[i] - rays.azimuth_low) * to_column);
    const int row = int((rays.sin_elevation[i] - rays.sin_elevation_low) * to_row);
    cell[i] = uint32_t(row << 16 | column);
  }
  for (uint32_t i = 0; i < n; ++i) {
    ++columns[cell[i] & 0xffff];
    ++rows[cell[i] >> 16];
  }
  // A quarter turn is 1 in `azimuth` and π/2 in angle. Elevation is measured by its sine.
  const float width = to_column > 0 ? occupied(columns) / to_column * float(M_PI / 2) : 1e-6f;
  const float height = to_row > 0 ? occupied(rows) / to_row : 1e-6f;
  const float tiles = std::max(1.0f, float(n) / float(kPacketRays));
  const float bands = std::clamp(std::round(std::sqrt(tiles * height / width)), 1.0f, tiles);
  cut(rows, bands, n, strip_of_row);
  const float side = std::sqrt(width * height / tiles), reach = kBunch * side;
  Items items;
  bunch(rays, n, reach * float(2 / M_PI), reach, items);
  const uint32_t count = items.count;
  if (items.bunched) {
    columns = {};
    for (uint32_t i = 0; i < count; ++i) ++columns[(cell[i] = cell[items.first[i]]) & 0xffff];
  }
  to_starts(columns);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t strip = strip_of_row[cell[i] >> 16];
    ++of_band[strip / kStrips];
    by_column[columns[cell[i] & 0xffff]++] = strip << 13 | i;
  }
  // Every other band runs backwards, so that a tile across the ends of two bands is in one place.
  std::array<uint32_t, kMostBands> at;
  for (size_t b = 0, sum = 0; b < kMostBands; ++b) {
    at[b] = uint32_t(b % 2 ? sum + of_band[b] : sum);
    sum += of_band[b];
  }
  std::array<uint32_t, kBatchRays>& by_band = cell;
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t band = (by_column[k] >> 13) / kStrips;
    by_band[band % 2 ? --at[band] : at[band]++] = by_column[k];
  }
  if (!items.bunched) {
    sort_tiles({by_band.data(), n}, order);
    return side;
  }
  for (uint32_t k = 0, to = 0; k < count; ++k) {
    const uint32_t item = by_band[k] & (kBatchRays - 1);
    for (uint32_t i = items.first[item]; i < items.first[item + 1]; ++i) order[to++] = i;
  }
  return side;
}

bool DirectionOrder::fits(const FloatRays& rays, size_t count) const {
  if (count != count_) return false;
  const float turn = slack_rad_ * float(2 / M_PI), up = slack_rad_;
  for (size_t begin = 0; begin < count; begin += kLooked) {
    const size_t end = std::min(count, begin + kLooked);
    uint32_t far = 0;
    for (size_t i = begin; i < end; ++i) {
      far += !(std::abs(rays.azimuth[i] - azimuth_[i]) < turn);
      far += !(std::abs(rays.sin_elevation[i] - sin_elevation_[i]) < up);
    }
    if (far > 0) return false;
  }
  return true;
}

const uint32_t* DirectionOrder::of(const FloatRays& rays, size_t count) {
  static constexpr uint32_t kOnly[1 + kPacketRays] = {};
  if (count == 1) return kOnly;
  if (fits(rays, count)) return order_;
  slack_rad_ = kSlack * order_by_direction(rays, {order_, count});
  std::copy_n(rays.azimuth, count, azimuth_);
  std::copy_n(rays.sin_elevation, count, sin_elevation_);
  std::fill_n(order_ + count, kPacketRays, order_[count - 1]);
  count_ = count;
  return order_;
}

}  // namespace underbrush::trace
