/// \file
/// The comparison of lists of objects as text and a report.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "report/table.hpp"
#include "underbrush/perception/list_scores.hpp"

namespace underbrush::report {

/// Lists with their name.
struct NamedLists {
  std::string name;
  std::vector<perception::ObjectList> lists;
};

/// Returns the scores of several lists against one reference, side by side.
Table table_of(const std::string& reference, std::span<const std::string> names,
               std::span<const perception::ListScore> scores);
/// Returns the normalised errors of [rosenberger20] Table 1.
Table table_of(std::span<const perception::ComparedObject> objects, const std::string& simulated,
               const std::string& real);

/// Writes a report: boxes and trajectories seen from above, existence over time for each object of
/// the reference, and the tables. Returns the path of the page.
std::filesystem::path write_list_report(const std::filesystem::path& folder,
                                        const std::string& title, const NamedLists& reference,
                                        std::span<const NamedLists> lists,
                                        std::span<const Table> tables,
                                        const std::string& provenance);
/// Returns the pictures of that report as HTML.
std::string list_pictures(const NamedLists& reference, std::span<const NamedLists> lists);

}  // namespace underbrush::report
