#include "underbrush/metrics/bearing_range.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "underbrush/core/check.hpp"

namespace underbrush::metrics {
namespace {

using Bin = BearingRangeHistogram::Bin;

uint64_t key_of(const Bin& bin) {
  return uint64_t(bin.ring) << 48 | uint64_t(bin.bearing) << 32 | bin.range;
}
uint32_t direction_of(const Bin& bin) { return uint32_t(key_of(bin) >> 32); }

std::vector<Bin> merged(const std::vector<Bin>& a, const std::vector<uint64_t>& keys) {
  std::vector<Bin> out;
  out.reserve(a.size());
  size_t i = 0;
  for (size_t k = 0; k < keys.size();) {
    while (i < a.size() && key_of(a[i]) < keys[k]) out.push_back(a[i++]);
    Bin bin{uint16_t(keys[k] >> 48), uint16_t(keys[k] >> 32), uint32_t(keys[k]), 0};
    if (i < a.size() && key_of(a[i]) == keys[k]) bin.count = a[i++].count;
    const uint64_t key = keys[k];
    for (; k < keys.size() && keys[k] == key; ++k) ++bin.count;
    out.push_back(bin);
  }
  out.insert(out.end(), a.begin() + std::ptrdiff_t(i), a.end());
  return out;
}

/// Calls `visit(bin of a, bin of b)` for the bins that are in both.
template <class Visit>
void for_each_shared(std::span<const Bin> a, std::span<const Bin> b, const Visit& visit) {
  size_t j = 0;
  for (const Bin& bin : a) {
    while (j < b.size() && key_of(b[j]) < key_of(bin)) ++j;
    if (j < b.size() && key_of(b[j]) == key_of(bin)) visit(bin, b[j]);
  }
}

double coefficient(std::span<const Bin> a, double total_a, std::span<const Bin> b, double total_b) {
  double sum = 0;
  for_each_shared(a, b, [&](const Bin& p, const Bin& q) {
    sum += std::sqrt(double(p.count)) * std::sqrt(double(q.count));
  });
  return std::min(1.0, sum / std::sqrt(total_a * total_b));
}

std::span<const Bin> of_direction(const std::vector<Bin>& bins, uint32_t direction) {
  const auto before = [](const Bin& bin, uint32_t d) { return direction_of(bin) < d; };
  const auto after = [](uint32_t d, const Bin& bin) { return d < direction_of(bin); };
  return {std::lower_bound(bins.begin(), bins.end(), direction, before),
          std::upper_bound(bins.begin(), bins.end(), direction, after)};
}

double sum_of(std::span<const Bin> bins) {
  double sum = 0;
  for (const Bin& bin : bins) sum += bin.count;
  return sum;
}

void check_comparable(const BearingRangeHistogram& a, const BearingRangeHistogram& b) {
  require(a.bins().bearing_rad == b.bins().bearing_rad && a.bins().range_m == b.bins().range_m,
          "histograms of different bins cannot be compared");
}

}  // namespace

BearingRangeHistogram::BearingRangeHistogram(const BearingRangeBins& bins,
                                             const Pose& world_from_sensor)
    : bins_(bins), sensor_from_world_(world_from_sensor.inverse()) {
  require(bins.bearing_rad > 0 && bins.range_m > 0, "a histogram's bins must be positive");
  require(2 * M_PI / bins.bearing_rad < 65535, "a histogram's bearing step is too small");
}

void BearingRangeHistogram::add(const BeamLog& beams) {
  constexpr size_t kChunk = 1 << 20;
  const int64_t turn = std::llround(2 * M_PI / bins_.bearing_rad);
  std::vector<uint64_t> keys;
  for (size_t begin = 0; begin < beams.size(); begin += kChunk) {
    const size_t end = std::min(begin + kChunk, beams.size());
    keys.clear();
    for (size_t i = begin; i < end; ++i) {
      const Vec3 d = sensor_from_world_.rotation * beams.direction[i].cast<double>();
      const int64_t step = std::llround(std::atan2(d.y(), d.x()) / bins_.bearing_rad);
      const bool hit = beams.is_hit(i);
      const double at = hit ? std::floor(double(beams.range_m[i]) / bins_.range_m) : 0;
      keys.push_back(key_of({beams.ring[i], uint16_t((step + turn) % turn),
                             hit ? uint32_t(std::clamp(at, 0.0, 4e9)) : kNoReturn, 0}));
    }
    std::sort(keys.begin(), keys.end());
    occupied_ = merged(occupied_, keys);
  }
  total_ += beams.size();
}

void BearingRangeHistogram::add(const BearingRangeHistogram& other) {
  check_comparable(*this, other);
  std::vector<Bin> sum;
  sum.reserve(occupied_.size() + other.occupied_.size());
  const auto before = [](const Bin& a, const Bin& b) { return key_of(a) < key_of(b); };
  std::merge(occupied_.begin(), occupied_.end(), other.occupied_.begin(), other.occupied_.end(),
             std::back_inserter(sum), before);
  occupied_.clear();
  for (const Bin& bin : sum) {
    if (!occupied_.empty() && key_of(occupied_.back()) == key_of(bin)) {
      occupied_.back().count += bin.count;
    } else {
      occupied_.push_back(bin);
    }
  }
  total_ += other.total_;
}

double bhattacharyya_coefficient(const BearingRangeHistogram& a, const BearingRangeHistogram& b) {
  check_comparable(a, b);
  require(a.total() > 0 && b.total() > 0, "a histogram is empty");
  return coefficient(a.occupied(), double(a.total()), b.occupied(), double(b.total()));
}

double bhattacharyya_distance(const BearingRangeHistogram& a, const BearingRangeHistogram& b) {
  return 0 - std::log(bhattacharyya_coefficient(a, b));
}

std::vector<DirectionOverlap> direction_overlaps(const BearingRangeHistogram& a,
                                                 const BearingRangeHistogram& b) {
  check_comparable(a, b);
  std::vector<DirectionOverlap> out;
  const std::vector<Bin>& bins = a.occupied();
  for (size_t i = 0; i < bins.size();) {
    const std::span<const Bin> of_a = of_direction(bins, direction_of(bins[i]));
    const std::span<const Bin> of_b = of_direction(b.occupied(), direction_of(bins[i]));
    const double c = of_b.empty() ? 0 : coefficient(of_a, sum_of(of_a), of_b, sum_of(of_b));
    out.push_back({bins[i].ring, bins[i].bearing, c});
    i += of_a.size();
  }
  return out;
}

}  // namespace underbrush::metrics
