/// The logs that a report compares.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace underbrush::report {

using Json = nlohmann::ordered_json;

/// A real log, the logs simulated from its beams, and their scores.
struct Comparison {
  std::string title;           ///< Heading of its section; empty where the page has no other.
  std::string note;            ///< A banner, e.g. "Synthetic data: …"; may be empty.
  Json scores;                 ///< `json_of_scores()`, with the names of `simulated` as models.
  std::filesystem::path real;  ///< The real log.
  /// A simulated log and its name.
  struct Simulated {
    std::string name;
    std::filesystem::path log;
  };
  std::vector<Simulated> simulated;  ///< Logs of the same beams, in the order of the columns.
};

}  // namespace underbrush::report
