#include <fmt/format.h>

#include <cmath>

#include "cli/progress.hpp"
#include "mover_score.hpp"
#include "osi_lists.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/movers/find_movers.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace movers_verb {

struct Arguments {
  std::string log, output, only, truth;
  double truth_elevation_deg = 0;
  movers::MoverOptions options;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("LOG", a.log, "The log (ray cloud PLY)")->required();
  verb.output("-o,--output", a.output, "The log with the returns of movers marked (ray cloud PLY)")
      ->type_name("MARKED.ply");
  verb.output("--only", a.only, "The beams that met movers, as a log of their own")
      ->type_name("MOVERS.ply");
  app.add_option("--truth", a.truth,
                 "Hold the marks against labelled boxes (CSV with frame and track_id) or lists of "
                 "objects")
      ->type_name("FILE");
  app.add_option("--truth-elevation-deg", a.truth_elevation_deg,
                 "Turn labelled boxes up by this angle, as import turned the beams")
      ->capture_default_str();
  verb.begin_rare_group("Search");
  auto& o = a.options;
  app.add_option("--look-s", o.look_s, "Times before and after a scan at which others are asked, s")
      ->capture_default_str();
  app.add_option("--least-empty", o.least_empty,
                 "Outermost looks that must have found a place empty")
      ->capture_default_str();
  app.add_option("--cell-deg", o.cell_deg,
                 "Width of the cells in which scans are compared, degrees")
      ->capture_default_str();
  app.add_option("--max-range", o.max_range_m, "Returns farther away are not looked at, m")
      ->capture_default_str();
  app.add_option("--same-m", o.same_m, "Ranges that differ by no more are of one thing, m")
      ->capture_default_str();
  app.add_option("--least-points", o.least_points, "Returns of the smallest mover in a scan")
      ->capture_default_str();
}

/// Writes the outputs and returns the number of returns.
size_t write_marked(io::LogReader& log, const std::vector<uint8_t>& mark, const Arguments& a,
                    const std::string& origin) {
  std::optional<io::LogWriter> all, only;
  if (!a.output.empty()) all.emplace(a.output, log.info(), origin);
  if (!a.only.empty() && std::ranges::count(mark, 1) > 0) only.emplace(a.only, log.info(), origin);
  log.rewind();
  size_t row = 0, returns = 0;
  for (BeamLog chunk; log.next(chunk); row += chunk.size()) {
    movers::mark_movers(mark, row, chunk);
    for (size_t i = 0; i < chunk.size(); ++i) returns += chunk.is_hit(i);
    if (all) all->write(chunk);
    if (!only) continue;
    BeamLog part = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (mark[row + i]) part.append(chunk, i);
    }
    only->write(part);
  }
  if (all) all->close();
  if (only) only->close();
  return returns;
}

void run(const Verb& verb, const Arguments& a) {
  a.options.check();
  require(!a.output.empty() || !a.only.empty() || !a.truth.empty(),
          "movers: nothing to do: give -o, --only or --truth");
  for (const std::string& path : {a.output, a.only}) {
    if (!path.empty()) io::check_output(path);
  }
  io::LogReader log(a.log);
  movers::require_two_scans(log, a.log);
  std::vector<std::filesystem::path> inputs{a.log};
  std::optional<perception::LogTruth> truth;
  if (!a.truth.empty()) {
    truth = truth_of_log(a.truth, log.info(), {a.truth_elevation_deg * M_PI / 180});
    inputs.emplace_back(a.truth);
  }
  const std::string origin = provenance(verb, inputs);
  Progress progress("movers");
  const std::vector<uint8_t> mark = movers::find_movers(log, a.options, std::ref(progress));
  const size_t marked = size_t(std::count(mark.begin(), mark.end(), 1));
  const size_t returns = write_marked(log, mark, a, origin);
  Json j = {
      {"rows", mark.size()}, {"returns", returns}, {"marked", marked}, {"skipped", log.skipped()}};
  std::string text = fmt::format("{} of {} returns are of movers\n", marked, returns);
  if (!a.only.empty() && marked == 0)
    text += "  nothing moved, so " + a.only + " was not written\n";
  if (truth) {
    const MoverScore score = score_movers(log, mark, *truth);
    j["truth"] = json_of(score);
    text += text_of(score);
  }
  verb.report(j, text);
}

}  // namespace movers_verb
}  // namespace

void add_movers(Program& program) {
  using namespace movers_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Logs", "movers", "Mark the returns of what moved during a log",
               "underbrush movers log.ply -o marked.ply && underbrush fit marked.ply -o model/\n"
               "  underbrush movers log.ply -o marked.ply --only cars.ply --truth objects.csv",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
