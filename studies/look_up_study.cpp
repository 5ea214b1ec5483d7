// This study puts the look-up, the obvious baseline of a simulator that is fitted to a log, beside
// the default and the mesh.
#include <fmt/format.h>

#include <cmath>

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

metrics::Score score_of(const BeamLog& test, BeamSource& simulated) {
  MemorySource real(test);
  return metrics::score(real, simulated, {});
}

metrics::Score score_of(const BeamLog& test, const BeamLog& answered) {
  MemorySource simulated(answered);
  return score_of(test, simulated);
}

elements::Model fit_half(const BeamLog& train, std::string_view fitter, uint64_t seed) {
  fit::FitOptions options;
  options.fitter = fitter;
  options.seed = seed;
  if (train.info.scans.size() > 1) options.min_range_m = kVehicleM;
  MemorySource source(train);
  return pipeline::fit_model({source}, options).model;
}

metrics::Score score_of_model(const elements::Model& model, const BeamLog& test,
                              const std::string& draw, uint64_t seed) {
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.draw = draw;
  const BeamLog answered = pipeline::simulate_log(model, test, options);
  MemorySource simulated(answered);
  return score_of(test, simulated);
}

void add_row(const std::string& log, const char* name, const metrics::Score& s,
             report::Table& table, Json& figures) {
  const metrics::Summary& a = s.all;
  table.rows.push_back(
      {fmt::format("{}/{}", log, name), fmt::format("{:.3f}", a.informedness),
       fmt::format("{:.3f}", a.f1_of_misses), fmt::format("{:.3f}", a.capped_error_m),
       fmt::format("{:.3f}", a.packet_error_m), fmt::format("{:.4f}", a.f1),
       fmt::format("{:.4f}", a.cloud_error_m), fmt::format("{:.3f}", a.median_range_error_m),
       fmt::format("{:.1f} ({:.1f})", 100 * s.roughness_m, 100 * s.real_roughness_m)});
  figures[log][name] = {
      {"informedness", a.informedness},         {"f1_of_misses", a.f1_of_misses},
      {"recall_of_misses", a.recall_of_misses}, {"capped_error_m", a.capped_error_m},
      {"packet_error_m", a.packet_error_m},     {"f1", a.f1},
      {"cloud_error_m", a.cloud_error_m},       {"median_range_error_m", a.median_range_error_m},
      {"roughness_m", s.roughness_m},           {"roughness_real_m", s.real_roughness_m}};
}

/// Adds the rows of the baselines that need no model, and returns the least capped error of the
/// look-ups, m. Keeps their answers in `keep`, unless it is empty.
double add_baselines(const std::string& log, const BeamLog& train, const BeamLog& test,
                     const fs::path& keep, report::Table& table, Json& figures) {
  const auto capped_error_of = [&](const char* name, const BeamLog& answered) {
    const metrics::Score s = score_of(test, answered);
    add_row(log, name, s, table, figures);
    if (!keep.empty()) {
      fs::create_directories(keep / log);
      io::write_log(keep / log / (std::string(name) + ".ply"), answered, "{}");
    }
    return s.all.capped_error_m;
  };
  capped_error_of("always hit", metrics::always_hit(train, test));
  const std::pair<const char*, metrics::LookUp> ways[] = {
      {"look-up, raw", metrics::LookUp::kRaw},
      {"look-up, 1 scan", metrics::LookUp::kWarped1},
      {"look-up, 2 scans", metrics::LookUp::kWarped2}};
  double best = INFINITY;
  for (const auto& [name, kind] : ways) {
    best = std::min(best, capped_error_of(name, metrics::looked_up(train, test, kind)));
  }
  return best;
}

}  // namespace

StudyResult study_look_up(const StudyRun& run) {
  StudyResult out;
  out.lead =
      "Held-out beams answered by the median ranges of the training rings, by what the training "
      "beams near them measured, by a mesh, and by the default. A quick study has the baselines "
      "without a model only.";
  report::Table table{
      "Look-up",
      "Always hit: the median range of the ring in the training log. Raw: the nearest beam of the "
      "nearest training scan. One or two scans: the end points of the nearest training scans, seen "
      "from each beam's own origin. In brackets the real log's roughness.",
      {"log/source", "informedness", "F1 of misses", "capped error, m", "packet error, m",
       "F1 of hits", "cloud error, m", "median range error, m", "roughness, cm"},
      {}};
  const std::vector<fs::path> logs =
      run.data.empty() ? std::vector<fs::path>{} : halved_logs(run.data);
  for (const fs::path& folder : logs) {
    const std::string log = folder.filename().string();
    run.say(log);
    const BeamLog train = io::read_log(folder / "train.ply"),
                  test = io::read_log(folder / "test.ply");
    out.inputs.insert(out.inputs.end(), {folder / "train.ply", folder / "test.ply"});
    const double best = add_baselines(log, train, test, run.keep, table, out.figures);
    if (run.quick) continue;
    const auto score_of = [&](const elements::Model& model, const std::string& draw) {
      return score_of_model(model, test, draw, run.seed);
    };
    const elements::Model mesh = fit_half(train, "surface", run.seed),
                          model = fit_half(train, fit::FitOptions().fitter, run.seed);
    add_row(log, "mesh", score_of(mesh, "on_ray"), table, out.figures);
    const metrics::Score ours = score_of(model, "on_ray");
    add_row(log, "default", ours, table, out.figures);
    add_row(log, "default, median", score_of(model, "median"), table, out.figures);
    out.checks.push_back({log + ": capped error of the default over the best look-up's",
                          ours.all.capped_error_m / best, 1.0});
  }
  if (out.inputs.empty()) out.notes.push_back("no logs: --data DIR names their folder");
  out.tables.push_back(std::move(table));
  return out;
}

}  // namespace underbrush::studies
