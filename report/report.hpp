/// Report that compares simulated logs with the real one on a page of tables, plots and pictures.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/comparison.hpp"

namespace underbrush::report {

/// The content of a report. A page of several comparisons begins with a table of contents.
struct ReportInput {
  std::string title;  ///< Title of the page.
  std::string lead;   ///< The line below the title; if empty, the contents of the first real log.
  std::vector<Comparison> comparisons;
};

/// Returns the page of the scores (`json_of_scores()`) of logs against the log `real`.
ReportInput page_of_scores(Json scores, const std::filesystem::path& real,
                           std::vector<Comparison::Simulated> simulated);

/// Writes `folder`/index.html, atomically: one file that loads nothing else; returns its path.
/// Reads each log in chunks. Throws as `io::LogReader` does, `std::invalid_argument` where there is
/// no comparison, a model has no scores or a simulated log ends early, `IoError` where the file
/// system refuses.
std::filesystem::path write_report(const std::filesystem::path& folder, const ReportInput& input);

/// Throws the `IoError` that `write_report` would end with. Callers use it before a long
/// computation.
void check_report_output(const std::filesystem::path& folder);

}  // namespace underbrush::report
