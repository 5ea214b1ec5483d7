// This study holds the whole instrument against a log of several echoes a pulse: how many there
// are, and how far apart.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "studies/echo_counts.hpp"
#include "studies/studies.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::studies {
namespace {

namespace fs = std::filesystem;

constexpr int kSubRays = 25;

/// The model of `fit` without options, which uses the first echoes.
elements::Model fitted_by_default(const BeamLog& train, uint64_t seed) {
  fit::FitOptions options;
  options.seed = seed;
  MemorySource rows(train);
  return pipeline::fit_model({rows}, options).model;
}

/// A model of all echoes.
elements::Model fitted(const BeamLog& train, std::string_view fitter, uint64_t seed) {
  fit::FitOptions options;
  options.fitter = fitter;
  options.tau = 4;
  options.seed = seed;
  fit::take_all_echoes(options, false);
  MemorySource rows(train);
  return pipeline::fit_model({rows}, options).model;
}

BeamLog answered(const elements::Model& model, const std::string& matter, BeamLog beams,
                 uint64_t seed) {
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.matter = matter;
  options.instrument.super_sample = std::to_string(kSubRays);
  keep_first_echoes(beams);
  return pipeline::simulate_log(model, std::move(beams), options);
}

std::string quantiles(const std::array<double, 3>& q) {
  return fmt::format("{:.2f} / {:.2f} / {:.2f}", q[0], q[1], q[2]);
}

void add_row(const std::string& name, const EchoCounts& c, const EchoCounts& real,
             report::Table& table, Json& figures) {
  std::vector<std::string> row{name, fmt::format("{:.1f}", 100 * c.share(2)),
                               fmt::format("{:.2f}", 100 * c.share(3))};
  for (const bool ground : {false, true}) {
    row.push_back(fmt::format("{:.1f}", 100 * c.share_of_class(ground)));
  }
  for (size_t band = 0; band < EchoCounts::kBands; ++band) {
    row.push_back(fmt::format("{:.1f}", 100 * c.share_in_band(band)));
  }
  row.push_back(quantiles(c.gaps()));
  row.push_back(fmt::format("{:.3f}", c.distance(real)));
  table.rows.push_back(std::move(row));
  const std::array<double, 3> gaps = c.gaps();
  Json& j = figures[name];
  j = {{"two", c.share(2)},
       {"three", c.share(3)},
       {"two_above_ground", c.share_of_class(false)},
       {"two_on_ground", c.share_of_class(true)},
       {"gap_m", gaps},
       {"distance", c.distance(real)}};
  for (size_t band = 0; band < EchoCounts::kBands; ++band) {
    j["two_in_band"].push_back(c.share_in_band(band));
  }
}

/// Adds the rows and checks of a log.
void run_log(const StudyRun& run, const fs::path& folder, report::Table& table, StudyResult& out) {
  const std::string log = folder.filename().string();
  const BeamLog train = io::read_log(folder / "train.ply");
  BeamLog test = io::read_log(folder / "test.ply");
  if (!test.extra.count(kEchoColumn)) {
    out.notes.push_back(log + ": one echo a beam");
    return;
  }
  out.inputs.insert(out.inputs.end(), {folder / "train.ply", folder / "test.ply"});
  run.say(log + ": fit");
  const elements::Model usual = fitted_by_default(train, run.seed);
  const elements::Model model = fitted(train, "hierarchical", run.seed);
  const elements::Model likely = fitted(train, "likelihood", run.seed);
  const elements::Model mesh = fitted(train, "surface", run.seed);
  const EchoCounts real(test, model);
  run.say(log + ": simulate");
  const EchoCounts by_default(answered(usual, "once", test, run.seed), model);
  const EchoCounts ours(answered(model, "once", test, run.seed), model);
  const EchoCounts anew(answered(model, "anew", test, run.seed), model);
  const EchoCounts refined(answered(likely, "once", test, run.seed), model);
  const EchoCounts opaque(answered(mesh, "once", test, run.seed), model);
  const std::pair<const char*, const EchoCounts*> rows[] = {
      {"real", &real},       {"default", &by_default}, {"once", &ours},
      {"refined", &refined}, {"anew", &anew},          {"mesh", &opaque}};
  add_row(log + "/the other half", EchoCounts(train, model), real, table, out.figures);
  for (const auto& [name, counts] : rows) {
    add_row(log + "/" + name, *counts, real, table, out.figures);
  }
  // The limits are the study's own: a quarter more or fewer pulses of several echoes, gaps within a
  // fifth.
  const auto off = [](double value, double expected) {
    return std::abs(std::log(value / expected));
  };
  out.checks.push_back({log + ": pulses of several echoes, |log of simulated over real|",
                        off(by_default.share(2), real.share(2)), std::log(1.1)});
  for (size_t band = 0; band < EchoCounts::kBands; ++band) {
    out.checks.push_back({log + ": the same, " + EchoCounts::name_of_band(band),
                          off(by_default.share_in_band(band), real.share_in_band(band)),
                          std::log(1.25)});
  }
  out.checks.push_back({log + ": median gap, |log of simulated over real|",
                        off(by_default.gaps()[1], real.gaps()[1]), std::log(1.2)});
  out.checks.push_back({log + ": distance of the counts over that of the mesh",
                        by_default.distance(real) / opaque.distance(real), 0.5});
  out.checks.push_back({log + ": without a grain, pulses of several echoes over the real ones",
                        anew.share(2) / real.share(2), 1.5, false});
}

}  // namespace

StudyResult study_echoes(const StudyRun& run) {
  StudyResult out;
  out.lead =
      "Held-out pulses of a log of several echoes, answered by the instrument on models that were "
      "fitted to the others.";
  report::Table table{
      "Echoes",
      "Shares of the pulses that return at all, %. Default: of fit without options, which uses the "
      "first echoes; the others are of all echoes. Once: matter drawn once, with the grain that "
      "the fit learnt, of the fitter hierarchical; refined: of likelihood. Anew: as once, but a "
      "draw for each sub-ray. Above: the first echo is more than 0.2 m above the ground. Gaps: "
      "quartiles of the distance of neighbouring echoes. Distance: half the sum of the absolute "
      "differences of the shares of 1, 2 and more echoes, by class and range.",
      {"log/source", "2 or more, %", "3 or more, %", "2 or more above, %",
       "2 or more on ground, %"},
      {}};
  for (size_t band = 0; band < EchoCounts::kBands; ++band) {
    table.head.push_back("2 or more, " + EchoCounts::name_of_band(band) + ", %");
  }
  table.head.insert(table.head.end(), {"gaps, m", "distance"});
  const std::vector<fs::path> logs =
      run.data.empty() ? std::vector<fs::path>{} : halved_logs(run.data);
  for (const fs::path& folder : logs) run_log(run, folder, table, out);
  if (out.inputs.empty()) {
    out.notes.push_back("no logs of several echoes: --data DIR names their folder");
  }
  out.tables.push_back(std::move(table));
  return out;
}

}  // namespace underbrush::studies
