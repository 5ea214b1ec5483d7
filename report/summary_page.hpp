/// \file
/// A page with a verdict, tables and pictures, for the report of a study or of a parameter search.
#pragma once
#include <filesystem>
#include <string>

namespace underbrush::report {

/// The content of the page. `asked` and `body` are HTML; all else is text and is escaped.
struct SummaryPage {
  std::string title, lead, verdict;
  std::string asked;       ///< The question that the verdict answers.
  std::string body;        ///< Tables, notes and pictures.
  std::string provenance;  ///< JSON.
};

/// Writes `folder`/index.html, atomically, as one file that loads no other, and returns its path.
/// Throws `IoError` where the file system refuses.
std::filesystem::path write_summary_page(const std::filesystem::path& folder,
                                         const SummaryPage& page);

}  // namespace underbrush::report
