/// \file
/// The unit of the times of the points of a recording.
#pragma once
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/io/open_log.hpp"

namespace underbrush::io {

/// Turns columns of times into seconds, in the unit that is found in the first scan of 20 points
/// and more whose times differ.
///
/// A name that ends in _ns, _us, _ms or _s gives the unit. Whole numbers are ns and others s, if
/// that fits: the times of a scan span at most 1.3 of the period and at least a twentieth of it or
/// 20 ms. Else the unit is the one of ns, µs, ms and s that fits, or the values are shares of the
/// scan's period. Where the period is not known, times of 1 ms to 10 000 s fit in the usual unit,
/// and 10 ms to 1 s in others.
class PointTimes {
 public:
  /// `period_s` is the spacing of the scans, s; 0 = not known.
  explicit PointTimes(double period_s = 0, TimesCount count = TimesCount::kAfter)
      : period_s_(period_s), count_(count) {}

  /// Returns times in s: those beyond 100 s are absolute, others count from `scan_time_s`, or as
  /// given. Where the period is known and the first time is absolute and more than 10 s from
  /// `scan_time_s`, or is not and is more than 1 s from it, the sensor has a clock of its own, such
  /// as µs since the hour, and the first time is that of the scan. Throws `FormatError` where no
  /// unit fits.
  std::vector<double> seconds(const std::string& file, const std::string& name,
                              const ExtraColumn& column, double scan_time_s);
  /// The assumption that was made; empty where the unit is the usual one.
  const std::string& note() const { return note_; }

 private:
  struct Span {
    double low = 0, span = 0;
    size_t count = 0;
  };
  bool fits(double span_s, bool usual) const;
  double unit_of(const std::string& file, const std::string& name, bool whole, Span values);

  double period_s_, unit_s_ = 0;
  TimesCount count_;
  bool own_clock_ = false;
  std::string note_;
};

/// Returns the names that columns of times have, in the order in which they are looked for.
const std::vector<std::string>& time_names();

}  // namespace underbrush::io
