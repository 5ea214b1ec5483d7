#include "studies/program.hpp"

#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "cli/verb.hpp"
#include "report/report.hpp"
#include "studies/study.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::studies {
namespace {

struct Arguments {
  std::string name, report, data, keep;
  bool quick = false;
};

const Study& study_named(const std::string& name) {
  std::vector<std::string> names;
  for (const Study& s : studies()) {
    if (name == s.name) return s;
    names.emplace_back(s.name);
  }
  throw std::invalid_argument(
      fmt::format("study: no study '{}'; there are: {}", name, fmt::join(names, ", ")));
}

void list(const app::Verb& verb) {
  Json j = Json::array();
  std::string text;
  for (const Study& s : studies()) {
    j.push_back({{"name", s.name}, {"summary", s.summary}});
    text += fmt::format("{:<14}{}\n", s.name, s.summary);
  }
  verb.report(j, text);
}

// Returns whether the study holds.
bool run(const app::Verb& verb, const Arguments& a) {
  if (a.name == "list") {
    list(verb);
    return true;
  }
  const Study& study = study_named(a.name);
  if (!a.report.empty()) report::check_report_output(a.report);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  StudyRun asked{verb.seed, a.quick, a.data, a.keep, [&](const std::string& line) {
                   std::cerr << fmt::format("[{:5.1f} s] {}\n", seconds(), line) << std::flush;
                 }};
  const StudyResult result = study.run(asked);
  const std::string origin = app::provenance(verb, result.inputs);
  Json j = json_of(study, result);
  j["quick"] = a.quick;
  j["seconds"] = seconds();
  j["provenance"] = Json::parse(origin);
  std::string text = text_of(result);
  if (!a.report.empty()) {
    text +=
        fmt::format("report: {}\n", write_study_report(a.report, study, result, origin).string());
  }
  verb.report(j, text);
  return holds(result.checks);
}

void add_options(app::Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("NAME", a.name, "The study, or list for a list of them")->required();
  app.add_flag("--quick", a.quick, "Run at a small size, for tests; the figures are rougher");
  verb.output("--report", a.report, "Write a report (one HTML file) into this folder",
              {"index.html"})
      ->type_name("DIR");
  app.add_option("--data", a.data,
                 "Folder of real logs, each a folder with train.ply and test.ply, or as the study "
                 "describes")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  verb.output("--keep", a.keep, "Keep the logs and models made on the way in this folder",
              {"train.ply"})
      ->type_name("DIR");
}

}  // namespace

int run_program(int argc, char** argv) {
  app::Program program(
      "underbrush-study",
      "Reproduce a paper's table or figure; ends with a verdict: exit code 1 if it falls short.");
  Arguments a;
  bool holds = true;
  const auto verb = app::make_verb(
      program,
      "underbrush-study list\n  underbrush-study vegetation --report study/ --json study.json",
      [&](const app::Verb& v) { holds = run(v, a); });
  add_options(*verb, a);
  const int code = program.run(argc, argv);
  return code == 0 && !holds ? 1 : code;
}

}  // namespace underbrush::studies
