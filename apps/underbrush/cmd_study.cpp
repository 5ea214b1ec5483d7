#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "report/report.hpp"
#include "study/study.hpp"
#include "underbrush/core/check.hpp"
#include "verbs.hpp"

namespace underbrush::app {
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

void list(const Verb& verb) {
  Json j = Json::array();
  std::string text;
  for (const Study& s : studies()) {
    j.push_back({{"name", s.name}, {"summary", s.summary}});
    text += fmt::format("{:<14}{}\n", s.name, s.summary);
  }
  verb.report(j, text);
}

void run(const Verb& verb, const Arguments& a) {
  if (a.name == "list") return list(verb);
  const Study& study = study_named(a.name);
  if (!a.report.empty()) check_report_output(a.report);
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  StudyRun asked{verb.seed, a.quick, a.data, a.keep, [&](const std::string& line) {
                   if (verb.json != "-")
                     std::cout << fmt::format("[{:5.1f} s] {}\n", seconds(), line) << std::flush;
                 }};
  const StudyResult result = study.run(asked);
  const std::string origin = provenance(verb, result.inputs);
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
}

}  // namespace

void add_study(CLI::App& root) {
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      root, "study", "Reproduce a paper's table or figure; ends with a verdict",
      "underbrush study list\n  underbrush study vegetation --report study/ --json study.json",
      [a](const Verb& v) { run(v, *a); });
  CLI::App& app = *verb->app;
  app.add_option("NAME", a->name, "The study, or list")->required();
  app.add_flag("--quick", a->quick, "A small size, for tests: the figures are rougher");
  app.add_option("--report", a->report, "Write a report (one HTML file) into this folder")
      ->type_name("DIR");
  app.add_option(
         "--data", a->data,
         "Folder of real logs, each a folder with train.ply and test.ply, or as the study says")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  app.add_option("--keep", a->keep, "Keep the logs and models made on the way in this folder")
      ->type_name("DIR");
}

}  // namespace underbrush::app
