/// The report of a score: one HTML file that needs nothing else.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "verb.hpp"

namespace underbrush::app {

/// What a report shows.
struct ReportInput {
  std::string title;
  std::string note;            ///< A banner, such as that the data are synthetic; may be empty.
  Json scores;                 ///< As `json_of_scores` makes them.
  std::filesystem::path real;  ///< The real log.
  struct Simulated {
    std::string name;
    std::filesystem::path log;
  };
  std::vector<Simulated> simulated;  ///< Logs of the same beams, in the order of the scores.
};

/// Writes `folder`/index.html: tables, plots, pictures and a point view, all embedded. Returns its
/// path.
std::filesystem::path write_report(const std::filesystem::path& folder, const ReportInput& input);

}  // namespace underbrush::app
