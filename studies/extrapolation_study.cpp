// This study scores a model beyond the log that it was fitted to: past the end of a stretch, where
// a drive comes back, and between the rings.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "studies/extrapolation.hpp"
#include "studies/studies.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/metrics/look_up.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace {

namespace fs = std::filesystem;

constexpr uint16_t kEveryRing = 4;
constexpr const char* kSources[] = {"default", "mesh", "mesh, carved", "look-up", "always hit"};

/// Returns the beams of a log for which `wanted(chunk, i)` holds.
template <class Wanted>
BeamLog chosen(const fs::path& file, const Wanted& wanted) {
  io::BeamReader reader(file);
  BeamLog chunk, out;
  while (reader.next(chunk)) {
    if (out.empty()) out = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (wanted(chunk, i)) out.append(chunk, i);
    }
  }
  return out;
}

BeamLog scans_of(const fs::path& file, const std::vector<uint32_t>& scans) {
  const std::set<uint32_t> wanted(scans.begin(), scans.end());
  return chosen(file, [&](const BeamLog& log, size_t i) { return wanted.count(log.scan[i]) > 0; });
}

/// A score of the table.
struct TableScore {
  const char *heading, *key;
  int digits;
  double metrics::Summary::*value;
};

constexpr TableScore kScores[] = {
    {"informedness", "informedness", 3, &metrics::Summary::informedness},
    {"returns answered", "answered", 3, &metrics::Summary::recall},
    {"F1", "f1", 4, &metrics::Summary::f1},
    {"capped error, m", "capped_error_m", 3, &metrics::Summary::capped_error_m},
    {"median range error, m", "median_range_error_m", 3, &metrics::Summary::median_range_error_m}};
constexpr size_t kCappedError = 3;

/// Sums of the scores of one source over tests of one protocol.
struct ScoreSums {
  std::array<double, std::size(kScores)> sum{};
  size_t tests = 0;
};

/// The models of one training log.
class Sources {
 public:
  Sources(BeamLog train, uint64_t seed) : train_(std::move(train)), seed_(seed) {
    const bool drive = train_.info.scans.size() > 1;
    for (const bool carve : {false, true}) {
      fit::FitOptions mesh;
      mesh.fitter = "surface";
      mesh.surface.carve = carve;
      meshes_.push_back(fitted(mesh, drive));
    }
    model_ = fitted({}, drive);
  }

  /// Returns the scores of all sources, in the order of `kSources`.
  std::vector<metrics::Summary> score(const BeamLog& test) const {
    std::vector<metrics::Summary> out;
    for (const elements::Model* model : {&model_, &meshes_[0], &meshes_[1]}) {
      pipeline::SimulateOptions options;
      options.seed = seed_;
      out.push_back(scored(test, pipeline::simulate_log(*model, test, options)));
    }
    out.push_back(scored(test, metrics::looked_up(train_, test, metrics::LookUp::kWarped2)));
    out.push_back(scored(test, metrics::always_hit(train_, test)));
    return out;
  }

 private:
  elements::Model fitted(fit::FitOptions options, bool drive) const {
    options.seed = seed_;
    if (drive) options.min_range_m = kVehicleM;
    MemorySource source(train_);
    return pipeline::fit_model({source}, options).model;
  }

  static metrics::Summary scored(const BeamLog& test, const BeamLog& answered) {
    MemorySource real(test), simulated(answered);
    metrics::ScoreOptions options;
    options.cloud = false;
    return metrics::score(real, simulated, options).all;
  }

  BeamLog train_;
  uint64_t seed_;
  elements::Model model_;
  std::vector<elements::Model> meshes_;
};

/// The scores of one log, by protocol and source.
using Rows = std::map<std::string, std::vector<ScoreSums>>;

void add(Rows& rows, const std::string& protocol, const std::vector<metrics::Summary>& scores) {
  std::vector<ScoreSums>& sums = rows[protocol];
  sums.resize(scores.size());
  for (size_t k = 0; k < scores.size(); ++k) {
    for (size_t s = 0; s < std::size(kScores); ++s) sums[k].sum[s] += scores[k].*kScores[s].value;
    ++sums[k].tests;
  }
}

void add_drive(const StudyRun& run, const fs::path& file, const Path& path, Rows& rows) {
  for (const Continuation& c : continuations(path)) {
    run.say(fmt::format("  continuation from {} scans", c.train.size()));
    const Sources sources(scans_of(file, c.train), run.seed);
    if (!c.inside.empty()) add(rows, "inside the stretch", sources.score(scans_of(file, c.inside)));
    for (const auto& [beyond, scans] : c.beyond) {
      add(rows, fmt::format("{} m beyond", beyond), sources.score(scans_of(file, scans)));
    }
  }
  if (const std::optional<SecondPass> pass = second_pass(path)) {
    run.say("  another pass");
    add(rows, "another pass",
        Sources(scans_of(file, pass->train), run.seed).score(scans_of(file, pass->test)));
  }
}

/// Learns every fourth ring of up to ten scans and answers the other rings.
void add_denser(const StudyRun& run, const fs::path& file, const Path& path, Rows& rows) {
  std::vector<uint32_t> scans = path.scan;
  if (scans.size() > 10) {
    const auto first = scans.begin() + std::ptrdiff_t(scans.size() / 2 - 5);
    scans = {first, first + 10};
  }
  run.say("  denser");
  const BeamLog all = scans.empty() ? chosen(file, [](const BeamLog&, size_t) { return true; })
                                    : scans_of(file, scans);
  BeamLog train = all.like(), test = all.like();
  for (size_t i = 0; i < all.size(); ++i) {
    (all.ring[i] % kEveryRing == 0 ? train : test).append(all, i);
  }
  add(rows, "denser", Sources(std::move(train), run.seed).score(test));
}

void report_rows(const std::string& log, const Rows& rows, report::Table& table,
                 StudyResult& result) {
  for (const auto& [protocol, sums] : rows) {
    const std::string row = fmt::format("{}/{}", log, protocol);
    std::vector<std::string> cells{row};
    for (size_t s = 0; s < std::size(kScores); ++s) {
      std::string& cell = cells.emplace_back();
      for (size_t k = 0; k < sums.size(); ++k) {
        const double mean = sums[k].sum[s] / double(sums[k].tests);
        cell += fmt::format("{}{:.{}f}", k == 0 ? "" : " / ", mean, kScores[s].digits);
        result.figures[log][protocol][kSources[k]][kScores[s].key] = mean;
      }
    }
    for (size_t k = 0; k < sums.size(); ++k) {
      result.figures[log][protocol][kSources[k]]["tests"] = sums[k].tests;
    }
    table.rows.push_back(std::move(cells));
    double best = sums[1].sum[kCappedError];
    for (const ScoreSums& s : std::span(sums).subspan(2)) {
      best = std::min(best, s.sum[kCappedError]);
    }
    result.checks.push_back({row + ": capped error of the default over the best other source's",
                             sums[0].sum[kCappedError] / best, 1.0});
  }
}

}  // namespace

StudyResult study_extrapolation(const StudyRun& run) {
  StudyResult out;
  out.lead =
      "Real logs answered beyond what the models were fitted to: by the default, a mesh, a carved "
      "mesh and a look-up.";
  report::Table table{
      "Extrapolation",
      "default / mesh / carved mesh / look-up of two scans / always hit. Inside the stretch: "
      "scans between those that were fitted. Denser: fitted to every fourth ring. "
      "Returns answered: share of the measured returns that get a return.",
      {"log/protocol"},
      {}};
  for (const TableScore& s : kScores) table.head.emplace_back(s.heading);
  std::vector<fs::path> logs;
  if (!run.data.empty()) {
    for (const fs::path& folder : halved_logs(run.data)) {
      if (fs::exists(folder / "log.ply")) logs.push_back(folder / "log.ply");
    }
  }
  bool comes_back = false;
  for (const fs::path& file : logs) {
    const std::string log = file.parent_path().filename().string();
    run.say(log);
    out.inputs.push_back(file);
    const Path path = path_of(io::LogReader(file).info().scans);
    Rows rows;
    add_drive(run, file, path, rows);
    add_denser(run, file, path, rows);
    comes_back |= rows.count("another pass") > 0;
    report_rows(log, rows, table, out);
  }
  if (logs.empty()) out.notes.push_back("no logs: --data DIR names their folder");
  if (!logs.empty() && !comes_back) out.notes.push_back("no drive passes a place twice");
  out.tables.push_back(std::move(table));
  return out;
}

}  // namespace underbrush::studies
