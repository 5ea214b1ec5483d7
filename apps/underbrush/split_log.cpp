#include "split_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::app {
namespace {

/// Decides for whole scans (or packets), so that the two parts never share a beam.
class HeldOut {
 public:
  HeldOut(const HoldOut& a, BeamSource& log) : a_(a) {
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

  const HoldOut& a_;
  std::map<uint32_t, std::vector<Column>> columns_;
  std::vector<uint32_t> scan_;
  std::set<uint32_t> chosen_;
  double start_ = INFINITY;
};

}  // namespace

SplitStep split_log(const Verb& verb, const std::filesystem::path& path, const HoldOut& hold_out,
                    const std::filesystem::path& train_path,
                    const std::filesystem::path& test_path) {
  const int choices = (hold_out.every > 0) + (hold_out.columns > 0) + !hold_out.time.empty() +
                      !hold_out.region.empty();
  require(choices == 1, "split: give one of --every, --columns, --time and --region");
  io::LogReader log(path);
  const HeldOut held_out(hold_out, log);
  const std::string origin = provenance(verb, {path});
  io::LogWriter train(train_path, log.info(), origin), test(test_path, log.info(), origin);
  Progress progress("split");
  size_t count[2] = {0, 0}, done = 0;
  BeamLog chunk;
  while (log.next(chunk)) {
    BeamLog part[2] = {chunk.like(), chunk.like()};
    for (size_t begin = 0; begin < chunk.size();) {
      const bool out = held_out(chunk, begin);
      size_t end = begin + 1;
      while (end < chunk.size() && held_out(chunk, end) == out) ++end;
      part[out].append(chunk, begin, end);
      begin = end;
    }
    train.write(part[0]);
    test.write(part[1]);
    for (int k = 0; k < 2; ++k) count[k] += part[k].size();
    progress(done += chunk.size(), log.size());
  }
  if (count[0] == 0 || count[1] == 0) {
    throw FormatError(path.string(), "",
                      fmt::format("one part would be empty ({} beams to train, {} held out)",
                                  count[0], count[1]));
  }
  train.close();
  test.close();
  return {count[0], count[1], log.skipped()};
}

}  // namespace underbrush::app
