#include <fmt/format.h>

#include <algorithm>

#include "cli/option_table.hpp"
#include "cli/progress.hpp"
#include "report/clouds.hpp"
#include "report/report.hpp"
#include "score_objects.hpp"
#include "score_protocols.hpp"
#include "stages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/pipeline/score_json.inl"
#include "underbrush/pipeline/score_logs.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace score_verb {
namespace fs = std::filesystem;

struct Arguments {
  std::string real, report, truth, train;
  pipeline::ScoreOptions options;
  std::vector<std::string> simulated, models, names;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("REAL", a.real, "The real log, or real lists of objects (CSV, JSON)")->required();
  app.add_option("SIMULATED", a.simulated,
                 "Simulated logs. Their beams must be those of REAL, except with --protocol clouds")
      ->required();
  app.add_option("--model", a.models,
                 "Model, scene or world of each simulated log, in order; adds likelihood and CRPS")
      ->type_name("MODEL")
      ->allow_extra_args(false);
  app.add_option("--train", a.train,
                 "The log that the models were fitted to. The baseline look-up is then scored, "
                 "too, and the baseline always hit takes its ranges from this log")
      ->type_name("LOG");
  app.add_option("--name", a.names, "Name of each simulated log in the results, in order")
      ->allow_extra_args(false);
  add_report_option(verb, a.report);
  app.add_option("--truth", a.truth,
                 "True lists of objects; adds the errors of lists ([rosenberger20] Table 1)")
      ->type_name("OBJECTS");
  app::add_options(verb, pipeline::score_options(), a.options);
}

void score_clouds(const Verb& verb, const Arguments& a, const std::vector<Candidate>& candidates) {
  std::vector<metrics::NamedCloudScores> clouds;
  std::vector<fs::path> inputs{a.real};
  for (const Candidate& c : candidates) {
    io::LogReader real(a.real), simulated(c.log);
    try {
      clouds.push_back(
          {c.name, pipeline::score_clouds(real, simulated, shown<Progress>("score " + c.name))});
    } catch (const DataError& e) {
      throw FormatError(c.log.string(), "", e.what());
    }
    inputs.push_back(c.log);
  }
  const std::string origin = provenance(verb, inputs);
  std::string text;
  for (const report::Table& t : report::tables_of_clouds(clouds)) text += report::text_of(t) + "\n";
  if (!a.report.empty()) {
    text += "report: " + report::write_cloud_report(a.report, clouds, origin).string() + "\n";
  }
  verb.report(pipeline::json_of_clouds(clouds, origin), text);
}

void run(const Verb& verb, const Arguments& a) {
  require(a.models.empty() || a.models.size() == a.simulated.size(),
          "score: give one --model for each simulated log, or none");
  require(a.names.empty() || a.names.size() == a.simulated.size(),
          "score: give one --name for each simulated log, or none");
  std::vector<Candidate> candidates;
  std::vector<std::string> names;
  std::vector<fs::path> inputs{a.real};
  for (size_t k = 0; k < a.simulated.size(); ++k) {
    names.push_back(a.names.empty() ? fs::path(a.simulated[k]).stem().string() : a.names[k]);
    require(std::count(names.begin(), names.end(), names.back()) == 1,
            "score: two simulated logs of one name; distinguish them with --name");
    candidates.push_back({names.back(), a.simulated[k], a.models.empty() ? "" : a.models[k]});
    inputs.push_back(a.simulated[k]);
    if (!a.models.empty()) inputs.push_back(a.models[k]);
  }
  if (osi::is_list_file(a.real)) {
    require(a.models.empty() && a.options.protocol.empty() && !a.options.repeats && a.train.empty(),
            "score: --model, --train, --protocol and --repeats are for logs, not for lists of "
            "objects");
    return score_objects(verb, {a.real, a.simulated, names, a.truth, a.report});
  }
  require(a.truth.empty(), "score: --truth is for lists of objects, not for logs");
  if (!a.report.empty()) report::check_report_output(a.report);
  if (a.options.protocol == "clouds") {
    require(a.models.empty() && !a.options.repeats && a.train.empty(),
            "score: --model, --train and --repeats are for logs of the same beams, not for clouds");
    return score_clouds(verb, a, candidates);
  }
  const pipeline::Scores scores = score_logs(a.real, a.train, candidates, a.options);
  inputs.emplace_back(a.train);
  const Json results = pipeline::json_of_scores(scores, provenance(verb, inputs));
  std::string text = text_of_scores(scores);
  text += fmt::format("always hit: each beam returns at the median range of its ring in {}\n",
                      fs::path(a.train.empty() ? a.real : a.train).filename().string());
  if (const size_t movers = scores.simulated[0].score.mover_beams; movers > 0) {
    text += fmt::format("left out: {} beams that met something that moved\n", movers);
  }
  text += text_of_protocols(scores);
  if (!a.report.empty()) {
    std::vector<report::Comparison::Simulated> logs;
    logs.reserve(candidates.size());
    for (const Candidate& c : candidates) logs.push_back({c.name, c.log});
    const report::ReportInput page = report::page_of_scores(results, a.real, std::move(logs));
    text += "report: " + report::write_report(a.report, page).string() + "\n";
  }
  verb.report(results, text);
}

}  // namespace score_verb
}  // namespace

void add_score(Program& program) {
  using namespace score_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Simulation", "score",
               "Compare simulated logs with the real one, beam by beam, or lists of objects",
               "underbrush score real.ply sim.ply --model model/ --json - --report report/\n"
               "  underbrush score tripod.ply other-tripod.ply --protocol clouds\n"
               "  underbrush score real.ply default.ply mesh.ply --name default --name mesh\n"
               "  underbrush score real.json sim.json --truth truth.json",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
