/// \file
/// This file has the times of the hits and misses of an element, which distinguish things that
/// moved away from thin matter.
#pragma once
#include <cstdint>

namespace underbrush::credit {

/// A sum of times and of their squares. The sums are exact, so that they depend neither on the
/// order of the beams nor on the number of threads.
struct TimeSums {
  int64_t count = 0, ticks = 0, squares = 0;

  /// Adds a time since the first beam, s. Times are rounded to 2⁻⁶ s, and those of more than a day
  /// count as a day. Any number of threads may add at once.
  void add_shared(double since_s);
  void add(const TimeSums& other);
  /// The standard deviation of the times, s; 0 without any.
  double spread_s() const;
};

/// The times of the trials of one element.
struct TrialTimes {
  TimeSums hits, misses;

  void add(const TrialTimes& other);
  /// Whether the hits came within a short part of the time in which beams crossed the element:
  /// their times spread less than `kBriefSpread` of those of all trials. Hits and misses at thin
  /// matter that stays alternate, whereas something that moves stops beams while it is there and
  /// lets them pass before and after. Trials within `kLeastSpreadS`, and single hits, do not
  /// suffice.
  bool are_brief() const;
};

inline constexpr double kBriefSpread = 0.4, kLeastSpreadS = 0.3;

}  // namespace underbrush::credit
