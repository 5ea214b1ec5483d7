#include "report/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "report/page.hpp"

namespace underbrush::report {
namespace {

/// Counts the characters, not the bytes, of UTF-8 text.
size_t width_of(const std::string& text) {
  return size_t(std::count_if(text.begin(), text.end(),
                              [](char c) { return (static_cast<uint8_t>(c) & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, size_t width, bool left) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return left ? text + space : space + text;
}

}  // namespace

std::string text_of(const Table& table) {
  std::vector<size_t> width(table.head.size());
  const auto widen = [&](const std::vector<std::string>& row) {
    for (size_t c = 0; c < row.size(); ++c) width.at(c) = std::max(width[c], width_of(row[c]));
  };
  widen(table.head);
  for (const auto& row : table.rows) widen(row);
  std::string text = table.title + "\n";
  const auto add = [&](const std::vector<std::string>& row) {
    text += " ";
    for (size_t c = 0; c < row.size(); ++c) text += " " + padded(row[c], width[c] + 1, c == 0);
    text += "\n";
  };
  add(table.head);
  for (const auto& row : table.rows) add(row);
  return text;
}

std::string html_of(const Table& table) {
  std::string html =
      fmt::format("<h2>{}</h2>\n<div class=\"scroll\"><table><thead><tr>", escaped(table.title));
  for (const std::string& h : table.head) html += "<th>" + escaped(h) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (size_t c = 0; c < row.size(); ++c) {
      html += fmt::format("<{0}>{1}</{0}>", c ? "td" : "th", escaped(row[c]));
    }
    html += "</tr>\n";
  }
  return html + fmt::format("</tbody></table></div>\n<p class=\"caption\">{}</p>\n",
                            escaped(table.caption));
}

}  // namespace underbrush::report
