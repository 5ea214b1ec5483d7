#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "cli/progress.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

struct Arguments {
  std::string log, train, test;
  int every = 0, offset = 1;
  std::vector<double> time, region;
  int columns = 0;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log")->required();
  verb.output("--train", a.train, "Where the beams that are kept for fitting go")->required();
  verb.output("--test", a.test, "Where the beams that are held out go")->required();
  auto* group = app.add_option_group("What is held out (one of)");
  group->add_option("--every", a.every, "Every K-th scan")->check(CLI::Range(2, 1 << 30));
  group
      ->add_option(
          "--columns", a.columns,
          "Every K-th column of each scan: the beams fired at one time (where the log has no "
          "times of beams: in one packet)")
      ->check(CLI::Range(2, 1 << 30));
  group
      ->add_option("--time", a.time, "Scans whose time lies in [FROM, TO), s after the log's start")
      ->expected(2)
      ->type_name("FROM TO");
  group
      ->add_option("--region", a.region,
                   "Scans whose sensor stands in this rectangle of the world, m")
      ->expected(4)
      ->type_name("X0 Y0 X1 Y1");
  group->require_option(1);
  app.add_option("--offset", a.offset,
                 "With --every and --columns: number (mod K) that is held out")
      ->capture_default_str();
}

/// Decides for whole scans (or packets), so that the two parts never share a beam.
class HeldOut {
 public:
  HeldOut(const Arguments& a, BeamSource& log) : a_(a) {
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

  const Arguments& a_;
  std::map<uint32_t, std::vector<Column>> columns_;
  std::vector<uint32_t> scan_;
  std::set<uint32_t> chosen_;
  double start_ = INFINITY;
};

void run(const Verb& verb, const Arguments& a) {
  io::LogReader log(a.log);
  const HeldOut held_out(a, log);
  const std::string origin = provenance(verb, {a.log});
  io::LogWriter train(a.train, log.info(), origin), test(a.test, log.info(), origin);
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
    throw FormatError(a.log, "",
                      fmt::format("one part would be empty ({} beams to train, {} held out)",
                                  count[0], count[1]));
  }
  train.close();
  test.close();
  Json j;
  j["train_beams"] = count[0];
  j["test_beams"] = count[1];
  j["skipped"] = log.skipped();
  verb.report(j, fmt::format("{} beams to train in {}, {} held out in {}\n", count[0], a.train,
                             count[1], a.test));
}

}  // namespace

void add_split(Program& program) {
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(program, "Logs", "split",
                             "Hold out part of a log, so that training and test never share a beam",
                             "underbrush split log.ply --every 2 --train train.ply --test test.ply",
                             [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
