/// The text and tables of a report's page, as HTML.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "report/markup.hpp"
#include "report/report.hpp"

namespace underbrush::report {

/// 1234567 as "1 234 567", with thin spaces that do not break.
std::string grouped(size_t n);

/// Returns the table with metrics as rows and models as columns; the best of each row is bold.
std::string headline_table(const ReportInput& input);
/// Returns a table of hits and misses, real by simulated, for each model.
std::string confusion_tables(const ReportInput& input);
/// Returns the recall and packet error of each class; empty if the log has no classes.
std::string class_table(const ReportInput& input);
/// Returns the provenance in a readable form.
std::string provenance_text(const ReportInput& input);

/// Returns the report's page with style and script in it, each @@key@@ replaced by its value.
std::string filled_page(const std::map<std::string, std::string>& values);
/// Returns the page of a `SummaryPage`, each @@key@@ replaced by its value.
std::string filled_summary(const std::map<std::string, std::string>& values);
/// Writes `folder`/index.html, atomically, and returns its path. Throws `IoError`.
std::filesystem::path write_page(const std::filesystem::path& folder, const std::string& page);

}  // namespace underbrush::report
