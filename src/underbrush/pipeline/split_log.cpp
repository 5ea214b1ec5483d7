#include "underbrush/pipeline/split_log.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kMost = 1 << 30;

/// Decides for whole scans (or packets), so that the two parts never share a beam.
class HeldOut {
 public:
  HeldOut(const SplitOptions& a, BeamSource& log) : a_(a) {
    const LogInfo& info = log.info();
    if (a.columns) collect_columns(log);
    for (const ScanInfo& s : info.scans) {
      scan_.push_back(s.scan);
      start_ = std::min(start_, s.time_s);
    }
    std::sort(scan_.begin(), scan_.end());
    require(!scan_.empty() || a.time.empty(), "split: the log has no scan times; use --every");
    for (const ScanInfo& s : info.scans) {
      const Vec3& at = s.world_from_sensor.translation;
      const bool in_time =
          !a.time.empty() && s.time_s - start_ >= a.time[0] && s.time_s - start_ < a.time[1];
      const bool in_region = !a.region.empty() && at.x() >= a.region[0] && at.x() < a.region[2] &&
                             at.y() >= a.region[1] && at.y() < a.region[3];
      if (in_time || in_region) chosen_.insert(s.scan);
    }
    require(!scan_.empty() || a.region.empty(), "split: the log has no scan poses; use --every");
  }

  bool operator()(const BeamLog& log, size_t i) const {
    if (a_.columns) {
      const std::vector<Column>& columns = columns_.at(log.scan[i]);
      const auto column =
          std::lower_bound(columns.begin(), columns.end(), column_of(log, i)) - columns.begin();
      return int(column % a_.columns) == a_.offset % a_.columns;
    }
    if (a_.every) {
      const auto at = std::lower_bound(scan_.begin(), scan_.end(), log.scan[i]);
      const size_t place =
          at != scan_.end() && *at == log.scan[i] ? size_t(at - scan_.begin()) : log.scan[i];
      return int(place % size_t(a_.every)) == a_.offset % a_.every;
    }
    return chosen_.count(log.scan[i]) > 0;
  }

 private:
  // A column: the beams of a scan that were fired at one time; where all times are the same (a
  // tripod's scan), the beams of one packet.
  using Column = std::pair<double, uint32_t>;
  static Column column_of(const BeamLog& log, size_t i) { return {log.time_s[i], log.packet[i]}; }

  void collect_columns(BeamSource& log) {
    BeamLog chunk;
    while (log.next(chunk)) {
      for (size_t i = 0; i < chunk.size(); ++i) {
        std::vector<Column>& columns = columns_[chunk.scan[i]];
        const Column column = column_of(chunk, i);
        if (columns.empty() || columns.back() != column) columns.push_back(column);
      }
    }
    for (auto& [scan, columns] : columns_) {
      std::sort(columns.begin(), columns.end());
      columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    }
    log.rewind();
  }

  const SplitOptions& a_;
  std::map<uint32_t, std::vector<Column>> columns_;
  std::vector<uint32_t> scan_;
  std::set<uint32_t> chosen_;
  double start_ = INFINITY;
};

}  // namespace

std::span<const Option<SplitOptions>> split_options() {
  using O = SplitOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"every", "What is held out (one of)", "", "Hold out one scan of every N",
     [](O& o) -> auto& { return o.every; }, 2, kMost},
    {"columns", "What is held out (one of)", "",
     "Hold out one column of every N in each scan; a column has the beams that were fired at one "
     "time, or those of one packet if the log has no times of beams",
     [](O& o) -> auto& { return o.columns; }, 2, kMost},
    {"time", "What is held out (one of)", "",
     "Hold out the scans whose time lies in [FROM, TO), s after the log's start",
     [](O& o) -> auto& { return o.time; }, -kNoLimit, kNoLimit, {}, "FROM TO", 2},
    {"region", "What is held out (one of)", "",
     "Hold out the scans whose sensor stands in this rectangle of the world, m",
     [](O& o) -> auto& { return o.region; }, -kNoLimit, kNoLimit, {}, "X0 Y0 X1 Y1", 4},
    {"offset", "", "",
     "With --every and --columns: number of the scan or column that is held out in each group of "
     "N, counted from 0",
     [](O& o) -> auto& { return o.offset; }},
  };
// clang-format on
return kOptions;
}

void SplitOptions::check() const {
  const int choices = (every > 0) + (columns > 0) + !time.empty() + !region.empty();
  require(choices == 1, "split: give one of --every, --columns, --time and --region");
  check_options("split", split_options(), *this);
  require(every + columns == 0 || (offset >= 0 && offset < every + columns),
          "split: --offset is the number in a group of --every or --columns, from 0");
  require(time.empty() || time.size() != 2 || time[0] < time[1],
          "split: --time takes the earlier time first");
  require((time.empty() || time.size() == 2) && (region.empty() || region.size() == 4),
          "split: a time has two numbers and a region four");
}

SplitCounts split_log(BeamSource& log, const SplitOptions& options,
                      const std::function<void(const BeamLog&, const BeamLog&)>& write,
                      const std::function<void(size_t, size_t)>& progress) {
  options.check();
  const HeldOut held_out(options, log);
  SplitCounts count;
  size_t done = 0;
  for (BeamLog chunk; log.next(chunk);) {
    BeamLog part[2] = {chunk.like(), chunk.like()};
    for (size_t begin = 0; begin < chunk.size();) {
      const bool out = held_out(chunk, begin);
      size_t end = begin + 1;
      while (end < chunk.size() && held_out(chunk, end) == out) ++end;
      part[out].append(chunk, begin, end);
      begin = end;
    }
    write(part[0], part[1]);
    count.train_beams += part[0].size();
    count.test_beams += part[1].size();
    if (progress) progress(done += chunk.size(), log.size());
  }
  if (count.train_beams == 0 || count.test_beams == 0) {
    throw DataError("one part would be empty (" + std::to_string(count.train_beams) +
                    " beams to train, " + std::to_string(count.test_beams) + " held out)");
  }
  return count;
}

}  // namespace underbrush::pipeline
