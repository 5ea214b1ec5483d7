#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (uint8_t(text.front()) <= ' ' || text.front() == '"')) {
    text.remove_prefix(1);
  }
  while (!text.empty() && (uint8_t(text.back()) <= ' ' || text.back() == '"')) {
    text.remove_suffix(1);
  }
  return text;
}

// Splits a line into cells. The separator ' ' stands for any run of spaces and tabs.
void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  if (separator == ' ') {
    cells = words_of(line);
    return;
  }
  cells.clear();
  for (size_t at = 0;;) {
    const size_t end = line.find(separator, at);
    cells.push_back(trimmed(line.substr(at, end == line.npos ? end : end - at)));
    if (end == line.npos) return;
    at = end + 1;
  }
}

char separator_of(std::string_view header) {
  for (const char c : {',', ';', '\t'}) {
    if (header.find(c) != header.npos) return c;
  }
  return ' ';
}

// Whole numbers become int32, or uint32 where that is too narrow; other columns stay double.
ExtraColumn narrowed(std::vector<double> values) {
  const auto fits = [&](double least, double most) {
    return std::all_of(values.begin(), values.end(),
                       [=](double v) { return v >= least && v <= most && v == std::floor(v); });
  };
  if (fits(std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max())) {
    return std::vector<int32_t>(values.begin(), values.end());
  }
  if (fits(0, std::numeric_limits<uint32_t>::max())) {
    return std::vector<uint32_t>(values.begin(), values.end());
  }
  return values;
}

bool is_coordinate_or_time(std::string_view name) {
  for (const char* known : {"x", "y", "z", "ox", "oy", "oz", "t", "time", "timestamp", "stamp"}) {
    if (name == known) return true;
  }
  return false;
}

}  // namespace

Table read_csv(const std::filesystem::path& path) {
  const std::string name = path.string(), text = read_file(path);
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<std::string_view> cells;
  char separator = ',';
  size_t line_number = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = std::string_view(text).substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at = end + 1;
    ++line_number;
    const auto fail = [&](const std::string& reason) {
      throw FormatError(name, "line " + std::to_string(line_number), reason);
    };
    if (names.empty()) {
      line = line.substr(std::min(line.find_first_not_of("#/ "), line.size()));
      if (line.empty()) continue;
      separator = separator_of(line);
      split(line, separator, cells);
      for (const auto& cell : cells) {
        if (number_of(cell)) fail("expected a line with the columns' names");
        names.emplace_back(cell);
        std::transform(names.back().begin(), names.back().end(), names.back().begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
        if (std::count(names.begin(), names.end(), names.back()) > 1) fail("a column twice");
      }
      columns.resize(names.size());
      continue;
    }
    if (trimmed(line).empty() || line[0] == '#') continue;
    split(line, separator, cells);
    if (cells.size() != names.size()) {
      fail("expected " + std::to_string(names.size()) + " values, found " +
           std::to_string(cells.size()));
    }
    for (size_t c = 0; c < cells.size(); ++c) {
      const auto value = cells[c].empty() ? std::optional<double>(NAN) : number_of(cells[c]);
      if (!value) fail("not a number: " + std::string(cells[c].substr(0, 40)));
      columns[c].push_back(*value);
    }
  }
  if (names.empty()) throw FormatError(name, "", "an empty file");
  Table table;
  for (size_t c = 0; c < names.size(); ++c) {
    table.columns.emplace_back(names[c], is_coordinate_or_time(names[c])
                                             ? ExtraColumn(std::move(columns[c]))
                                             : narrowed(std::move(columns[c])));
  }
  return table;
}

}  // namespace underbrush::io
