/// \file
/// A table for people, as text and as HTML.
#pragma once
#include <string>
#include <vector>

namespace underbrush::report {

/// A table of cells that are formatted already. The first cell of a row is its name.
struct Table {
  std::string title, caption;
  std::vector<std::string> head;               ///< One cell a column.
  std::vector<std::vector<std::string>> rows;  ///< As many cells each as `head`, or fewer.
};

/// The table with aligned columns under its title, without the caption.
std::string text_of(const Table& table);
/// The table as a section of a page, with title and caption; all text is escaped.
std::string html_of(const Table& table);

}  // namespace underbrush::report
