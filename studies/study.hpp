/// Studies: a paper's table or figure, reproduced by one command, with a verdict that can fail.
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "report/table.hpp"

namespace underbrush::studies {

using Json = nlohmann::ordered_json;

/// What a study is asked for.
struct StudyRun {
  uint64_t seed = 1;
  bool quick = false;          ///< A size for tests: seconds.
  std::filesystem::path data;  ///< Folder of real logs; empty: none.
  std::filesystem::path keep;  ///< Folder for the logs and models made on the way; empty: none.
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< Progress, a line.
};

/// A threshold and what was reached.
struct Check {
  std::string what;
  double value = 0, limit = 0;
  bool at_most = true;
  bool holds() const { return at_most ? value <= limit : value >= limit; }  ///< Not of NaN.
};

/// "holds", or "falls short: " and each check that does not hold.
std::string verdict(std::span<const Check> checks);

/// Folders of `data` that hold the halves of a log, train.ply and test.ply, in order of name.
std::vector<std::filesystem::path> halved_logs(const std::filesystem::path& data);

/// What a study found.
struct StudyResult {
  std::string lead;  ///< One sentence: what stands against what.
  Json figures = Json::object();
  std::vector<Check> checks;
  std::vector<report::Table> tables;
  std::vector<std::string> notes;  ///< What was left out, and why.
  std::string pictures;            ///< HTML for the report.
  std::vector<std::filesystem::path> inputs;
};

/// A study under its name.
struct Study {
  const char* name;
  const char* summary;
  StudyResult (*run)(const StudyRun&);
};
/// All studies.
std::span<const Study> studies();

/// `verdict`, `checks`, `figures`, `notes`.
Json json_of(const Study& study, const StudyResult& result);
/// Tables, notes and verdict.
std::string text_of(const StudyResult& result);
/// Writes `folder`/index.html, atomically: one file that loads nothing else; returns its path.
std::filesystem::path write_study_report(const std::filesystem::path& folder, const Study& study,
                                         const StudyResult& result, const std::string& provenance);

}  // namespace underbrush::studies
