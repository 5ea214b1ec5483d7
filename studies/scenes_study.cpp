// This study shows where a composed scene loses to a fit of the site itself: the scene is made true
// in one respect after the other.
#include <fmt/format.h>

#include "studies/ladder.hpp"
#include "studies/studies.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

using metrics::Summary;

constexpr size_t kLadderPairs = 3;
constexpr const char* kBottomRung = "composed";
constexpr const char* kTopRung = "and what stands in no box";

struct LadderColumn {
  const char* name;
  const char* key;
  double Summary::*value;
  int digits;
};
constexpr LadderColumn kLadderColumns[] = {
    {"packet error, m", "packet_error_m", &Summary::packet_error_m, 2},
    {"cloud error, m", "cloud_error_m", &Summary::cloud_error_m, 3},
    {"capped error, m", "capped_error_m", &Summary::capped_error_m, 3},
    {"F1", "f1", &Summary::f1, 4},
    {"F1 of misses", "f1_of_misses", &Summary::f1_of_misses, 3},
    {"informedness", "informedness", &Summary::informedness, 3}};

/// The ladders of the pairs of one site, with their names.
struct Ladders {
  std::vector<std::string> names;
  std::vector<std::vector<Rung>> rungs;

  Spread spread(size_t rung, double Summary::*value) const {
    std::vector<double> values;
    for (const std::vector<Rung>& one : rungs) values.push_back(one[rung].score.*value);
    return spread_of(values);
  }
  double mean(const std::string& name, double Summary::*value) const {
    for (size_t k = 0; k < rungs[0].size(); ++k) {
      if (rungs[0][k].name == name) return spread(k, value).mean;
    }
    return NAN;
  }
};

void climb(const StudyRun& run, const SitePair& pair, Ladders& out) {
  out.names.push_back(pair.name);
  out.rungs.push_back(ladder(pair, run.seed));
  run.say(pair.name);
  for (const Rung& r : out.rungs.back()) {
    std::string text = fmt::format("  {:<40}", r.name);
    for (const LadderColumn& c : kLadderColumns)
      text += fmt::format(" {:.{}f}", r.score.*c.value, c.digits);
    run.say(text);
  }
}

/// The gap between a composed scene and its ceiling shall be half of what it was when the study was
/// made: 1.43 m of packet error and 0.142 m of cloud error.
void add_ladder_checks(const std::string& where, const Ladders& all, StudyResult& result) {
  constexpr std::pair<double Summary::*, double> kGaps[] = {{&Summary::packet_error_m, 1.43 / 2},
                                                            {&Summary::cloud_error_m, 0.142 / 2}};
  for (const auto& [value, limit] : kGaps) {
    const char* name = value == &Summary::packet_error_m ? "packet" : "cloud";
    result.checks.push_back(
        {fmt::format("{}: {} error of the composed scene above the ceiling's", where, name),
         all.mean(kBottomRung, value) - all.mean(kTopRung, value), limit});
  }
  result.checks.push_back({where + ": informedness of the composed scene",
                           all.mean(kBottomRung, &Summary::informedness), 0, false});
}

void add_ladders(const std::string& where, const Ladders& all, StudyResult& result) {
  report::Table table{fmt::format("Ladder: {}", where),
                      fmt::format("Mean over {} pairs ± standard deviation over them. Each row is "
                                  "true in one more respect than the row above it.",
                                  all.rungs.size()),
                      {"scene"},
                      {}};
  Json& figures = result.figures[where];
  for (const LadderColumn& c : kLadderColumns) table.head.push_back(c.name);
  for (size_t k = 0; k < all.rungs[0].size(); ++k) {
    const std::string& name = all.rungs[0][k].name;
    table.rows.push_back({name});
    for (const LadderColumn& c : kLadderColumns) {
      const Spread s = all.spread(k, c.value);
      table.rows.back().push_back(
          fmt::format("{:.{}f} ± {:.{}f}", s.mean, c.digits, s.sd, c.digits));
      figures["mean"][name][c.key] = io::finite_or_null(s.mean);
    }
  }
  for (size_t p = 0; p < all.rungs.size(); ++p) {
    for (const Rung& r : all.rungs[p]) {
      for (const LadderColumn& c : kLadderColumns) {
        figures["pairs"][all.names[p]][r.name][c.key] = io::finite_or_null(r.score.*c.value);
      }
    }
  }
  result.tables.push_back(std::move(table));
  add_ladder_checks(where, all, result);
}

}  // namespace

StudyResult study_scenes(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "Composed scenes against fits of the sites themselves: the scene becomes true in one respect "
      "after the other.";
  Ladders sites;
  for (size_t k = 0; k < (run.quick ? 1 : kLadderPairs); ++k) {
    const uint64_t first = 1000 * run.seed + 2 * k;
    climb(run, generated_pair(first, first + 1, run.quick), sites);
  }
  add_ladders("generated sites", sites, result);
  const std::vector<fs::path> logs = drives_of(run.data);
  if (logs.empty()) result.notes.push_back("real drives were left out: no --data folder of logs");
  for (const fs::path& log : logs) {
    const std::string name = log.parent_path().filename().string();
    Ladders drive;
    for (const StretchPair& pair : pairs_of_drive(log)) {
      climb(run, read_stretches(log, pair), drive);
    }
    if (drive.rungs.empty()) {
      result.notes.push_back(name + " was left out: no two stretches of it are 100 m apart");
      continue;
    }
    add_ladders(name, drive, result);
    result.inputs.push_back(log);
  }
  return result;
}

}  // namespace underbrush::studies
