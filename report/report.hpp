/// A comparison of simulated logs with the real one as a page to read: tables, plots, pictures.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace underbrush::report {

using Json = nlohmann::ordered_json;

/// What a report is made of.
struct ReportInput {
  std::string title;
  std::string note;            ///< A banner, e.g. "Synthetic data: …"; may be empty.
  Json scores;                 ///< `json_of_scores()`, with the names of `simulated` as models.
  std::filesystem::path real;  ///< The real log.
  struct Simulated {
    std::string name;
    std::filesystem::path log;
  };
  std::vector<Simulated> simulated;  ///< Logs of the same beams, in the order of the columns.
};

/// Writes `folder`/index.html, atomically: one file that loads nothing else; returns its path.
/// Reads each log in chunks. Throws as `io::LogReader` does, `std::invalid_argument` where a model
/// has no scores or a simulated log ends early, `IoError` where the file system refuses.
std::filesystem::path write_report(const std::filesystem::path& folder, const ReportInput& input);

/// Throws the `IoError` that `write_report` would end with now: to be asked before long work.
void check_report_output(std::filesystem::path folder);

}  // namespace underbrush::report
