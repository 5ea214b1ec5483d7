/// \file
/// The largest range of a log's sensor or format, if its returns stop there.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace underbrush {

/// The returns of a log that come from near its largest range.
struct LastReturns {
  float largest_m = 0;
  /// The number of returns in each interval of `RangeCut`, from that of the largest range
  /// downwards.
  std::vector<uint32_t> counts;
};

/// Counts returns by their ranges, in intervals that are 0.4 to 0.8 % of the range wide.
class RangeCut {
 public:
  static constexpr size_t kMostCounts = 16;  ///< The greatest number of counts in `LastReturns`.

  void add(float range_m) {
    largest_m_ = std::max(largest_m_, range_m);
    ++count_[interval(range_m)];
  }
  void add(const LastReturns& other) {
    largest_m_ = std::max(largest_m_, other.largest_m);
    uint32_t k = interval(other.largest_m);
    for (const uint32_t count : other.counts) count_[k--] += count;
  }
  /// Returns the counts that are needed to go on with more returns.
  LastReturns last() const {
    LastReturns out{largest_m_, {}};
    for (uint32_t k = interval(largest_m_); k > interval(kBefore * largest_m_); --k) {
      out.counts.push_back(count_[k]);
    }
    return out;
  }
  /// Returns the largest range (m) where many returns come from near it: at least 50 from its last
  /// 2 %, and half as many as from the 2 % before. Where ranges thin out instead, they show the
  /// extent of the scene and not the sensor's limit, and the result is infinite.
  double reach_m() const {
    const size_t near = between(kNear, 1), before = between(kBefore, kNear);
    const bool cut = near >= 50 && 2 * near >= before;
    return cut ? double(largest_m_) : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr float kNear = 0.98f, kBefore = 0.96f;  // parts of the largest range

  /// The sign, the exponent and the first seven bits of the fraction of a float.
  static uint32_t interval(float range_m) { return std::bit_cast<uint32_t>(range_m) >> 16; }
  /// The returns from the intervals above that of `low` times the largest range, up to that of
  /// `high`.
  size_t between(float low, float high) const {
    size_t sum = 0;
    for (uint32_t k = interval(high * largest_m_); k > interval(low * largest_m_); --k) {
      sum += count_[k];
    }
    return sum;
  }

  float largest_m_ = 0;
  std::vector<uint32_t> count_ = std::vector<uint32_t>(1 << 15);  // of floats that are not negative
};

}  // namespace underbrush
