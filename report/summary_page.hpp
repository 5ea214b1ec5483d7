/// \file
/// A page with a verdict, tables and pictures: the report of a study or of a search for parameters.
#pragma once
#include <filesystem>
#include <string>

namespace underbrush::report {

/// What such a page shows. `asked` and `body` are HTML; all else is text and is escaped.
struct SummaryPage {
  std::string title, lead, verdict;
  std::string asked;       ///< What the verdict answers.
  std::string body;        ///< Tables, notes and pictures.
  std::string provenance;  ///< JSON.
};

/// Writes `folder`/index.html, atomically: one file that loads nothing else. Returns its path.
/// Throws `IoError` where the file system refuses.
std::filesystem::path write_summary_page(const std::filesystem::path& folder,
                                         const SummaryPage& page);

}  // namespace underbrush::report
