#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/perception/perceive_options.hpp"
#include "underbrush/pipeline/reports_json.inl"
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
  app.add_option("LOG", a.log, "The log (.ply or .ublog)")->required();
  verb.output("-o,--output", a.output,
              "The log with the returns of moving objects marked (.ply or .ublog)")
      ->type_name("MARKED.ply");
  verb.output("--only", a.only, "The beams that met moving objects, as a log")
      ->type_name("MOVERS.ply");
  app.add_option("--truth", a.truth,
                 "Compare the marks with labelled boxes (CSV with frame and track_id) or lists of "
                 "objects")
      ->type_name("FILE");
  app.add_option("--truth-elevation-deg", a.truth_elevation_deg, perception::kElevationHelp)
      ->capture_default_str();
  app::add_options(verb, movers::mover_options(), a.options);
}

/// The outputs of a marked log.
class Outputs {
 public:
  Outputs(const Arguments& a, const LogInfo& info, std::string origin)
      : a_(a), info_(info), origin_(std::move(origin)) {
    if (!a.output.empty()) all_.emplace(a.output, info, origin_);
  }

  void write(const BeamLog& chunk, std::span<const uint8_t> mark) {
    if (all_) all_->write(chunk);
    if (a_.only.empty()) return;
    BeamLog part = chunk.like();
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (mark[i]) part.append(chunk, i);
    }
    if (!only_ && !part.empty()) only_.emplace(a_.only, info_, origin_);
    if (only_) only_->write(part);
  }

  void close() {
    if (all_) all_->close();
    if (only_) only_->close();
  }

 private:
  const Arguments& a_;
  const LogInfo& info_;
  std::string origin_;
  std::optional<io::LogWriter> all_, only_;
};

std::string text_of(const perception::MoverScore& score) {
  std::string text;
  const auto add = [&](const std::string& what, const perception::MarkedReturns& m) {
    text += fmt::format("  {:<22} {:>8} of {:>8} returns marked\n", what, m.marked, m.returns);
  };
  for (const auto& [name, m] : score.moving) {
    add(fmt::format("{} moving {}", m.objects, name), m);
  }
  for (const auto& [name, m] : score.standing) {
    add(fmt::format("{} standing {}", m.objects, name), m);
  }
  add("in no labelled box", score.elsewhere);
  return text;
}

void run(const Verb& verb, const Arguments& a) {
  a.options.check();
  require(!a.output.empty() || !a.only.empty() || !a.truth.empty(),
          "movers: nothing to do: give -o, --only or --truth");
  for (const std::string& path : {a.output, a.only}) {
    if (!path.empty()) io::check_output(path);
  }
  io::LogReader log(a.log);
  std::optional<perception::LogTruth> truth;
  if (!a.truth.empty()) {
    truth = osi::truth_of_log(a.truth, log.info(), {a.truth_elevation_deg * M_PI / 180});
  }
  Outputs outputs(a, log.info(), provenance(verb, {a.log, a.truth}));
  const pipeline::MoverMarks found = pipeline::mark_movers(
      log, a.log, a.options,
      [&](const BeamLog& chunk, std::span<const uint8_t> mark) { outputs.write(chunk, mark); },
      shown<Progress>("movers"));
  outputs.close();
  std::string text = fmt::format("{} of {} returns are of movers\n", found.marked, found.returns);
  if (!a.only.empty() && found.marked == 0)
    text += "  nothing moved, so " + a.only + " was not written\n";
  std::optional<perception::MoverScore> score;
  if (truth) score = perception::score_movers(log, found.mark, *truth);
  if (score) text += text_of(*score);
  verb.report(json_of(found, score ? &*score : nullptr, log.skipped()), text);
}

}  // namespace movers_verb
}  // namespace

void add_movers(Program& program) {
  using namespace movers_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Logs", "movers", "Mark the returns of objects that moved during a log",
               "underbrush movers log.ply -o marked.ply && underbrush fit marked.ply -o model/\n"
               "  underbrush movers log.ply -o marked.ply --only cars.ply --truth objects.csv",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
