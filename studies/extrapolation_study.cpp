// This study asks how far a model may be trusted: beyond the end of what it was fitted to, where a
// drive comes back, and between the rings that it knows.
#include <fmt/format.h>

#include <algorithm>
#include <set>

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

/// What one source answers of a test log.
struct Answers {
  double answered = 0;  ///< Share of the real returns that it answers with a return.
  double f1 = 0, capped_error_m = 0, median_range_error_m = 0;
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

  /// Returns the answers of all sources, in the order of `kSources`.
  std::vector<Answers> score(const BeamLog& test) const {
    std::vector<Answers> out;
    for (const elements::Model* model : {&model_, &meshes_[0], &meshes_[1]}) {
      pipeline::SimulateOptions options;
      options.seed = seed_;
      out.push_back(answers(test, pipeline::simulate_log(*model, test, options)));
    }
    out.push_back(answers(test, metrics::looked_up(train_, test, metrics::LookUp::kWarped2)));
    out.push_back(answers(test, metrics::always_hit(train_, test)));
    return out;
  }

 private:
  elements::Model fitted(fit::FitOptions options, bool drive) const {
    options.seed = seed_;
    if (drive) options.min_range_m = kVehicleM;
    MemorySource source(train_);
    return pipeline::fit_model({source}, options).model;
  }

  static Answers answers(const BeamLog& test, const BeamLog& answered) {
    MemorySource real(test), simulated(answered);
    metrics::ScoreOptions options;
    options.cloud = false;
    const metrics::Summary s = metrics::score(real, simulated, options).all;
    return {s.recall, s.f1, s.capped_error_m, s.median_range_error_m, 1};
  }

  BeamLog train_;
  uint64_t seed_;
  elements::Model model_;
  std::vector<elements::Model> meshes_;
};

/// The answers of one log, by protocol and source.
using Rows = std::map<std::string, std::vector<Answers>>;

void add(Rows& rows, const std::string& protocol, const std::vector<Answers>& answers) {
  std::vector<Answers>& sum = rows[protocol];
  sum.resize(answers.size());
  for (size_t k = 0; k < answers.size(); ++k) {
    sum[k].answered += answers[k].answered;
    sum[k].f1 += answers[k].f1;
    sum[k].capped_error_m += answers[k].capped_error_m;
    sum[k].median_range_error_m += answers[k].median_range_error_m;
    ++sum[k].tests;
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
    std::string cells[4];
    for (size_t k = 0; k < sums.size(); ++k) {
      const double n = double(sums[k].tests);
      const Answers a{sums[k].answered / n, sums[k].f1 / n, sums[k].capped_error_m / n,
                      sums[k].median_range_error_m / n, sums[k].tests};
      const char* between = k == 0 ? "" : " / ";
      cells[0] += fmt::format("{}{:.3f}", between, a.answered);
      cells[1] += fmt::format("{}{:.4f}", between, a.f1);
      cells[2] += fmt::format("{}{:.3f}", between, a.capped_error_m);
      cells[3] += fmt::format("{}{:.3f}", between, a.median_range_error_m);
      result.figures[log][protocol][kSources[k]] = {
          {"answered", a.answered},
          {"f1", a.f1},
          {"capped_error_m", a.capped_error_m},
          {"median_range_error_m", a.median_range_error_m},
          {"tests", a.tests}};
    }
    table.rows.push_back({row, cells[0], cells[1], cells[2], cells[3]});
    double best = sums[1].capped_error_m;
    for (size_t k = 2; k < sums.size(); ++k) best = std::min(best, sums[k].capped_error_m);
    result.checks.push_back({row + ": capped error of the default over the best other source's",
                             sums[0].capped_error_m / best, 1.0});
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
      {"log/protocol", "returns answered", "F1", "capped error, m", "median range error, m"},
      {}};
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
