/// \file
/// Tables, as text and as HTML.
#pragma once
#include <string>
#include <vector>

namespace underbrush::report {

/// A table of formatted cells. The first cell of a row is its name.
struct Table {
  std::string title, caption;
  std::vector<std::string> head;               ///< One cell for each column.
  std::vector<std::vector<std::string>> rows;  ///< Each row has as many cells as `head`, or fewer.
};

/// Returns the table with aligned columns under its title, without the caption.
std::string text_of(const Table& table);
/// Returns the table as a section of a page, with title and caption; all text is escaped.
std::string html_of(const Table& table);

}  // namespace underbrush::report
