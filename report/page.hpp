/// The parts of a report's page that are text and tables.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "report/markup.hpp"
#include "report/report.hpp"

namespace underbrush::report {

/// 1234567 as "1 234 567", with thin spaces that do not break.
std::string grouped(size_t n);

/// Metrics as rows, models as columns, the best of each row in bold.
std::string headline_table(const ReportInput& input);
/// Hits and misses, real by simulated, of each model.
std::string confusion_tables(const ReportInput& input);
/// Recall and packet error of each class; empty if the log has no classes.
std::string class_table(const ReportInput& input);
/// The provenance, readable.
std::string provenance_text(const ReportInput& input);

/// The page with style and script in it, each @@key@@ replaced by its value.
std::string filled_page(const std::map<std::string, std::string>& values);
/// The page of a `SummaryPage`, filled in the same way.
std::string filled_summary(const std::map<std::string, std::string>& values);
/// Writes `folder`/index.html, atomically; returns its path. Throws `IoError`.
std::filesystem::path write_page(const std::filesystem::path& folder, const std::string& page);

}  // namespace underbrush::report
