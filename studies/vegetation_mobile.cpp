#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "studies/vegetation.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

/// The score of a contender on one log.
struct MobileScore {
  metrics::Summary all;
  size_t elements = 0;
  double fit_beams_per_s = 0;
};

MobileScore score_log(Contender c, const fs::path& folder, uint64_t seed) {
  MobileScore out;
  io::LogReader train(folder / "train.ply"), test(folder / "test.ply");
  if (train.info().scans.size() > 1) c.fit.min_range_m = kVehicleM;
  const auto start = std::chrono::steady_clock::now();
  const elements::Model model = pipeline::fit_model({train}, c.fit).model;
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  out.fit_beams_per_s = double(train.size()) / spent.count();
  out.elements = model.size();
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.matter = c.once ? "once" : "anew";
  const pipeline::TracedWorld world(model, pipeline::matter_of(options));
  pipeline::Simulation simulation(world, options);
  const BeamLog answered = pipeline::simulate_log(simulation, test);
  MemorySource simulated(answered);
  out.all = pipeline::score_log(test, simulated, &world, {.cloud = false}).all;
  return out;
}

report::Table table_of(const std::string& log, const std::vector<std::string>& names,
                       const std::vector<MobileScore>& scores) {
  report::Table table{"Mobile log " + log,
                      "Fitted on one half of the log, scored on the other; the volumes as `fit` "
                      "makes them, surface "
                      "and voxels as Deschaud et al. 2012. Default: drawn once for all beams, as "
                      "simulate does; the "
                      "other models are drawn anew for each beam, as in the paper.",
                      {"model", "packet error, m", "F1", "median range error, m", "NLL/beam",
                       "CRPS, m", "elements", "fit, beams/s"},
                      {}};
  for (size_t k = 0; k < names.size(); ++k) {
    const metrics::Summary& s = scores[k].all;
    table.rows.push_back(
        {names[k], fmt::format("{:.3f}", s.packet_error_m), fmt::format("{:.4f}", s.f1),
         fmt::format("{:.3f}", s.median_range_error_m), fmt::format("{:.3f}", s.nll_per_beam),
         fmt::format("{:.3f}", s.crps_m), std::to_string(scores[k].elements),
         fmt::format("{:.3g}", scores[k].fit_beams_per_s)});
  }
  return table;
}

/// Adds the checks that the default is the best of all in NLL, CRPS and F1.
void add_checks(const std::string& log, const std::vector<std::string>& names,
                const std::vector<MobileScore>& scores, std::vector<Check>& checks) {
  const metrics::Summary& mine = scores[0].all;
  for (size_t k = 1; k < names.size(); ++k) {
    if (names[k].starts_with(kDefault)) continue;  // The same model in the paper's protocol.
    const metrics::Summary& other = scores[k].all;
    const std::string against = fmt::format("{} on {} against {}, ", kDefault, log, names[k]);
    checks.push_back({against + "NLL", mine.nll_per_beam, other.nll_per_beam});
    checks.push_back({against + "CRPS", mine.crps_m, other.crps_m});
    checks.push_back({against + "F1", mine.f1, other.f1, false});
  }
}

}  // namespace

void add_mobile_logs(const StudyRun& run, StudyResult& result) {
  if (run.data.empty()) {
    result.notes.push_back("the mobile experiment was left out: no --data folder of logs");
    return;
  }
  const std::vector<fs::path> logs = halved_logs(run.data);
  if (logs.empty()) {
    result.notes.push_back("the mobile experiment was left out: no folder in " + run.data.string() +
                           " holds train.ply and test.ply");
  }
  for (const fs::path& log : logs) {
    const std::string name = log.filename().string();
    run.say("mobile log " + name);
    std::vector<std::string> names;
    std::vector<MobileScore> scores;
    for (const Contender& c : mobile_contenders(run.seed)) {
      names.push_back(c.name);
      scores.push_back(score_log(c, log, run.seed));
      const metrics::Summary& s = scores.back().all;
      result.figures["mobile"][name][c.name] = {{"packet_error_m", s.packet_error_m},
                                                {"f1", s.f1},
                                                {"median_range_error_m", s.median_range_error_m},
                                                {"nll_per_beam", s.nll_per_beam},
                                                {"crps_m", s.crps_m},
                                                {"elements", scores.back().elements},
                                                {"fit_beams_per_s", scores.back().fit_beams_per_s}};
    }
    result.tables.push_back(table_of(name, names, scores));
    add_checks(name, names, scores, result.checks);
    result.inputs.push_back(log / "train.ply");
    result.inputs.push_back(log / "test.ply");
  }
}

}  // namespace underbrush::studies
