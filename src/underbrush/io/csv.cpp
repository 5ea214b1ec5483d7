#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
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

/// The state of reading a text file of columns line by line.
class CsvReader {
 public:
  CsvReader(const std::string& file, const std::vector<std::string>& names) : file_(file) {
    for (const std::string& name : names) add_name(name);
    given_ = !names.empty();
  }

  void take(size_t line_number, std::string_view line) {
    line_number_ = line_number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (names_.empty() || (given_ && columns_.empty())) return begin(line);
    if (trimmed(line).empty() || line[0] == '#') return;
    split(line, separator_, cells_);
    // CloudCompare writes the number of points below the names.
    const bool first = columns_[0].empty();
    if (first && cells_.size() == 1 && names_.size() > 1 && is_count(cells_[0])) return;
    add_row();
  }

  Table finish() {
    if (names_.empty()) throw FormatError(file_, "", "an empty file");
    Table table;
    table.notes = std::move(notes_);
    columns_.resize(names_.size());
    for (size_t c = 0; c < names_.size(); ++c) {
      table.columns.emplace_back(names_[c], is_coordinate_or_time(names_[c])
                                                ? ExtraColumn(std::move(columns_[c]))
                                                : narrowed(std::move(columns_[c])));
    }
    return table;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(file_, "line " + std::to_string(line_number_), reason);
  }

  static bool is_count(std::string_view cell) {
    const auto value = number_of(cell);
    return value && *value >= 0 && *value == std::floor(*value);
  }

  void add_name(std::string_view cell) {
    std::string name = lower(std::string(cell));
    if (!seen_.insert(name).second) fail("a column twice");
    names_.push_back(std::move(name));
  }

  /// Takes the line of the names, or the first row of a file that has none.
  void begin(std::string_view line) {
    const std::string_view whole = line;
    line = line.substr(std::min(line.find_first_not_of("#/ "), line.size()));
    if (line.empty()) return;
    separator_ = separator_of(line);
    split(line, separator_, cells_);
    const bool numbers = std::all_of(cells_.begin(), cells_.end(),
                                     [](const auto& cell) { return number_of(cell).has_value(); });
    if (!numbers && !given_) {
      for (const auto& cell : cells_) {
        if (number_of(cell)) fail("a number among the columns' names");
        add_name(cell);
      }
      columns_.resize(names_.size());
      return;
    }
    if (!numbers || whole[0] == '#' || (cells_.size() == 1 && is_count(cells_[0]))) return;
    if (!given_) {
      if (cells_.size() < 3) fail("expected a line with the columns' names");
      for (size_t c = 0; c < cells_.size(); ++c) {
        add_name(c < 3 ? std::string(1, char('x' + c)) : "column_" + std::to_string(c + 1));
      }
      notes_.emplace_back(
          "no line names the columns: the first three are taken to be x y z "
          "(--columns names them)");
    }
    columns_.resize(names_.size());
    add_row();
  }

  void add_row() {
    if (cells_.size() != names_.size()) {
      fail("expected " + std::to_string(names_.size()) + " values, found " +
           std::to_string(cells_.size()));
    }
    for (size_t c = 0; c < cells_.size(); ++c) {
      const auto value = cells_[c].empty() ? std::optional<double>(NAN) : number_of(cells_[c]);
      if (!value) fail("not a number: " + std::string(cells_[c].substr(0, 40)));
      columns_[c].push_back(*value);
    }
  }

  const std::string& file_;
  bool given_ = false;  // The names do not come from the file.
  std::vector<std::string> names_, notes_;
  std::set<std::string> seen_;
  std::vector<std::vector<double>> columns_;
  std::vector<std::string_view> cells_;
  char separator_ = ',';
  size_t line_number_ = 0;
};

}  // namespace

Table read_csv(const std::filesystem::path& path, const std::vector<std::string>& names) {
  constexpr uint64_t kMostBytes = uint64_t(1) << 36;
  const std::string name = path.string(), text = read_text(path, kMostBytes);
  CsvReader reader(name, names);
  for_each_line(text, [&](size_t number, std::string_view line) { reader.take(number, line); });
  return reader.finish();
}

}  // namespace underbrush::io
