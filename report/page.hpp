/// The text and tables of a report's page, as HTML.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "report/comparison.hpp"
#include "report/markup.hpp"

namespace underbrush::report {

/// 1234567 as "1 234 567", with thin spaces that do not break.
std::string grouped(size_t n);

/// Metrics as rows, models and baselines as columns, the best of each row in bold; below it, a
/// description of the baselines.
std::string headline_table(const Comparison& input);
/// Hits and misses, real by simulated, of each model.
std::string confusion_tables(const Comparison& input);
/// Recall and packet error of each class below `heading`; empty if the log has no classes.
std::string class_table(const Comparison& input, const std::string& heading);
/// The provenance, readable.
std::string provenance_text(const Comparison& input);

/// Returns the report's page with style and script in it, each @@key@@ replaced by its value.
std::string filled_page(const std::map<std::string, std::string>& values);
/// The section of one comparison, filled in the same way.
std::string filled_section(const std::map<std::string, std::string>& values);
/// The page of a `SummaryPage`, filled in the same way.
std::string filled_summary(const std::map<std::string, std::string>& values);
/// Writes `folder`/index.html, atomically, and returns its path. Throws `IoError`.
std::filesystem::path write_page(const std::filesystem::path& folder, const std::string& page);

}  // namespace underbrush::report
