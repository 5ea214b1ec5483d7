/// Studies: each reproduces a table or figure of a paper by one command, with a verdict that can
/// fail.
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

/// The options of a study.
struct StudyRun {
  uint64_t seed = 1;
  bool quick = false;          ///< Runs at a size for tests, which takes seconds.
  std::filesystem::path data;  ///< Folder of real logs; empty: none.
  std::filesystem::path keep;  ///< Folder for the logs and models made on the way; empty: none.
  /// Reports progress, a line at a time.
  std::function<void(const std::string&)> say = [](const std::string&) {};
};

/// A threshold and the value that was reached.
struct Check {
  std::string what;
  double value = 0, limit = 0;
  bool at_most = true;
  /// A NaN does not hold.
  bool holds() const { return at_most ? value <= limit : value >= limit; }
};

/// Returns whether all checks hold. A study without a check compared nothing and does not hold.
bool holds(std::span<const Check> checks);
/// Returns "holds", or "falls short: " and each check that does not hold.
std::string verdict(std::span<const Check> checks);

/// The returns of a drive that are nearer than this are of the vehicle itself, m.
inline constexpr double kVehicleM = 2;

/// Returns the folders of `data` that hold the halves of a log, train.ply and test.ply, in order of
/// name.
std::vector<std::filesystem::path> halved_logs(const std::filesystem::path& data);

/// The results of a study.
struct StudyResult {
  std::string lead;  ///< A sentence on what the study compares.
  Json figures = Json::object();
  std::vector<Check> checks;
  std::vector<report::Table> tables;
  std::vector<std::string> notes;  ///< The parts that were left out, and why.
  std::string pictures;            ///< HTML for the report.
  std::vector<std::filesystem::path> inputs;
};

/// A study with its name.
struct Study {
  const char* name;
  const char* summary;
  StudyResult (*run)(const StudyRun&);
};
/// Returns all studies.
std::span<const Study> studies();

/// Returns `verdict`, `checks`, `figures` and `notes` as JSON.
Json json_of(const Study& study, const StudyResult& result);
/// Returns tables, notes and verdict as text.
std::string text_of(const StudyResult& result);
/// Writes `folder`/index.html, atomically, as one file that loads no other, and returns its path.
std::filesystem::path write_study_report(const std::filesystem::path& folder, const Study& study,
                                         const StudyResult& result, const std::string& provenance);

}  // namespace underbrush::studies
