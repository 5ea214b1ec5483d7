#include "underbrush/io/point_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "underbrush/core/check.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::io {
namespace {

constexpr double kLongestOffset = 100;  // s; a larger time is not an offset within a scan
constexpr double kLongestScan = 1e4;    // s
constexpr double kOtherClock = 10, kLateOffset = 1;    // s from a scan's time to its first point's
constexpr double kFirstDate = 1e9, kLastDate = 4.2e9;  // s since 1970: the years 2001 to 2103

struct Unit {
  const char* name;
  double seconds;
};
constexpr Unit kUnits[] = {{"ns", 1e-9}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1}};

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

/// The unit (s) that a name says at its end; 0 if it says none.
double unit_in_name(const std::string& name) {
  for (const Unit& unit : kUnits) {
    if (name.ends_with(std::string("_") + unit.name)) return unit.seconds;
  }
  return 0;
}

std::string shown(const Unit& unit) { return unit.seconds == 1e-6 ? "µs" : unit.name; }

}  // namespace

const std::vector<std::string>& time_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names{"t",          "time",          "timestamp",  "time_stamp",
                                   "stamp",      "time_offset",   "timeoffset", "offset_time",
                                   "offsettime", "adjustedtime",  "gps_time",   "gpstime",
                                   "ts",         "timestamps",    "times",      "point_time",
                                   "rel_time",   "relative_time", "time_rel",   "dt"};
    const size_t plain = names.size();
    for (size_t k = 0; k < plain; ++k) {
      for (const Unit& unit : kUnits) names.push_back(names[k] + "_" + unit.name);
    }
    return names;
  }();
  return kNames;
}

bool PointTimes::fits(double span_s, bool usual) const {
  if (period_s_ > 0) {
    return span_s <= 1.3 * period_s_ && span_s >= std::min(0.05 * period_s_, 0.02);
  }
  return usual ? span_s >= 1e-3 && span_s <= kLongestScan : span_s >= 0.01 && span_s <= 1;
}

double PointTimes::unit_of(const std::string& file, const std::string& name, bool whole,
                           Span values) {
  if (const double said = unit_in_name(name); said > 0) return unit_s_ = said;
  const double usual = whole ? 1e-9 : 1;
  for (const Unit& unit : kUnits) {  // The unit of dates follows from their size.
    const double date = values.low * unit.seconds, span = values.span * unit.seconds;
    const bool is_date = date > kFirstDate && date < kLastDate && span < kLongestScan;
    if (is_date && (!whole || unit.seconds == usual || fits(span, false))) return unit.seconds;
  }
  constexpr size_t kEnoughToTell = 20;
  if (unit_s_ > 0) return unit_s_;
  if (values.span == 0 || values.count < kEnoughToTell) return usual;
  if (fits(values.span * usual, true)) return unit_s_ = usual;
  const std::string spans = text_of(values.span) + " of them where scans are " +
                            text_of(period_s_ > 0 ? period_s_ : 0.1) + " s apart";
  for (const Unit& unit : kUnits) {
    if (unit.seconds == usual || !fits(values.span * unit.seconds, false)) continue;
    note_ = "the points' times (" + name + ") are taken to be " + shown(unit);
    note_ += ": a scan spans " + spans;
    return unit_s_ = unit.seconds;
  }
  const bool share = !whole && values.low >= 0 && values.low + values.span <= 1.001 &&
                     fits(values.span * period_s_, false);
  if (share) {
    note_ = "the points' times (" + name + ") are taken to be shares of a scan, 0 to 1: it spans " +
            spans;
    return unit_s_ = period_s_;
  }
  const bool offsets = values.low <= 2 * values.span;
  if (offsets && period_s_ > 0 && values.span * usual > 1.3 * period_s_) {
    throw FormatError(
        file, name,
        "the points' times are neither ns, µs, ms, s nor shares of a scan: it spans " + spans);
  }
  return usual;
}

std::vector<double> PointTimes::seconds(const std::string& file, const std::string& name,
                                        const ExtraColumn& column, double scan_time_s) {
  std::vector<double> time = doubles_of(column);
  double low = INFINITY, high = -INFINITY;
  size_t count = 0;
  for (const double t : time) {
    if (!std::isfinite(t)) continue;
    ++count;
    low = std::min(low, t);
    high = std::max(high, t);
  }
  if (!(low <= high)) return time;
  // A 64-bit count of nanoseconds was read as double.
  const bool whole = type_of(column) < ValueType::kF32 || std::max(-low, high) > 1e15;
  const double unit = unit_of(file, name, whole, {low, high - low, count});
  const bool absolute = std::max(-low, high) * unit > kLongestOffset;
  if (!absolute && count_ != TimesCount::kAfter) {
    const bool back = count_ == TimesCount::kBefore;
    for (double& t : time) t = scan_time_s + unit * (back ? -t : t - high);
    return time;
  }
  double begin = absolute ? 0 : scan_time_s;
  const double early = low * unit + begin - scan_time_s;  // The first point after the scan's time.
  if (period_s_ > 0 && high > low && std::abs(early) > (absolute ? kOtherClock : kLateOffset)) {
    begin -= early;
    if (!own_clock_) {
      note_ += note_.empty() ? "the points' times (" + name + ")" : ", and";
      note_ += " count from the scan's time, since their clock is another one: the first is " +
               text_of(low * unit) + " s";
    }
    own_clock_ = true;
  }
  for (double& t : time) t = t * unit + begin;
  return time;
}

}  // namespace underbrush::io
