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

/// A line of names without the units in brackets that are ours. Units of time become part of the
/// name, as in time_ns; others stay, and so the name is not known.
std::string without_units(std::string_view line) {
  std::string out;
  for (size_t at = 0; at < line.size(); ++at) {
    const size_t end =
        line[at] == '[' || line[at] == '(' ? line.find_first_of("])", at) : line.npos;
    if (end == line.npos) {
      out += line[at];
      continue;
    }
    const std::string unit = lower(std::string(trimmed(line.substr(at + 1, end - at - 1))));
    const bool time = unit == "ns" || unit == "us" || unit == "ms";
    const bool ours = time || unit.empty() || unit == "m" || unit == "s" || unit == "-";
    while (!out.empty() && out.back() == ' ') out.pop_back();
    out += !ours ? "[" + unit + "]" : time ? "_" + unit : "";
    at = end;
  }
  return out;
}

/// Whether a line has numbers with decimal commas.
bool has_decimal_commas(std::string line) {
  if (line.find(',') == line.npos) return false;
  std::ranges::replace(line, ',', '.');
  std::ranges::replace(line, ';', ' ');
  const auto words = words_of(line);
  return words.size() > 1 &&
         std::ranges::all_of(words, [](const auto& word) { return number_of(word).has_value(); });
}
constexpr const char* kDecimalCommas = "decimal commas: write the numbers with decimal points";

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
    line_ = line;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (trimmed(line).empty() || (line_number == 1 && line.starts_with("sep="))) return;
    if (names_.empty() || (given_ && columns_.empty())) return begin(line);
    if (line[0] == '#') return;
    split(line, separator_, cells_);
    // CloudCompare writes the number of points below the names.
    const bool first = columns_[0].empty();
    if (first && cells_.size() == 1 && names_.size() > 1 && is_count(cells_[0])) return;
    add_row();
  }

  Table finish() {
    if (names_.empty()) {
      throw FormatError(file_, "",
                        comments_.empty() ? "an empty file" : "no rows of numbers in it");
    }
    check_unnamed();
    Table table;
    table.notes = std::move(notes_);
    columns_.resize(names_.size());
    for (size_t c = 0; c < names_.size(); ++c) {
      if (names_[c].empty()) {
        table.notes.push_back(
            "column " + std::to_string(c + 1) +
            " has no name and is left out: a table's index, or a comma at the end");
        continue;
      }
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
    if (name.ends_with("_m") && is_coordinate_or_time(name.substr(0, name.size() - 2))) {
      name.resize(name.size() - 2);
    }
    if (!name.empty() && !seen_.insert(name).second) fail("a column twice");
    names_.push_back(std::move(name));
  }

  /// Takes the names of a line of names.
  void add_names(std::string_view line) {
    const std::string plain = without_units(line);
    split(plain, separator_of(plain), cells_);
    for (const auto& cell : cells_) add_name(cell);
    columns_.resize(names_.size());
  }

  /// Takes the names of the last comment above the first row that has as many names as that has
  /// values; the first three are x y z if there is none.
  void name_columns(size_t count) {
    for (auto comment = comments_.rbegin(); comment != comments_.rend(); ++comment) {
      const std::string plain = without_units(*comment);
      std::vector<std::string_view> cells;
      split(plain, separator_of(plain), cells);
      const bool number =
          std::ranges::any_of(cells, [](const auto& cell) { return number_of(cell).has_value(); });
      if (cells.size() == count && !number) return add_names(*comment);
    }
    if (count < 3) fail("expected a line with the columns' names");
    unnamed_ = true;
    for (size_t c = 0; c < count; ++c) {
      add_name(c < 3 ? std::string(1, char('x' + c)) : "column_" + std::to_string(c + 1));
    }
    notes_.emplace_back(
        "no line names the columns: the first three are taken to be x y z "
        "(--columns names them)");
  }

  /// Refuses rows without names whose numbers have decimal commas, and whose first column counts.
  void check_unnamed() const {
    constexpr size_t kEnough = 20;
    if (!unnamed_) return;
    if (columns_.size() % 2 == 0 && padded_ && !has_point_)
      throw FormatError(file_, "", kDecimalCommas);
    const std::vector<double>& first = columns_[0];
    bool counts =
        columns_.size() > 3 && first.size() >= kEnough && first[0] == std::floor(first[0]);
    for (size_t i = 1; i < first.size(); ++i) counts = counts && first[i] == first[i - 1] + 1;
    if (!counts) return;
    throw FormatError(
        file_, "", "its first column counts the rows: name the columns, as in --columns id,x,y,z");
  }

  /// Takes the line of the names, or the first row of a file that has none.
  void begin(std::string_view line) {
    if (line[0] == '#' || line.starts_with("//")) {
      line = line.substr(std::min(line.find_first_not_of("#/ "), line.size()));
      if (!line.empty()) comments_.emplace_back(line);
      return;
    }
    separator_ = separator_of(line);
    split(line, separator_, cells_);
    const size_t numbers = size_t(std::ranges::count_if(
        cells_, [](const auto& cell) { return number_of(cell).has_value(); }));
    const size_t empty = size_t(std::ranges::count(cells_, std::string_view()));
    if (numbers == 0 || numbers + empty < cells_.size()) {  // names
      if (given_) return;
      if (numbers > 0) {
        fail(has_decimal_commas(std::string(line)) ? kDecimalCommas
                                                   : "a number among the columns' names");
      }
      separator_ = separator_of(without_units(line));
      return add_names(line);
    }
    if (cells_.size() == 1 && is_count(cells_[0])) return;
    if (!given_) {
      const std::vector<std::string_view> row = cells_;
      name_columns(row.size());
      cells_ = row;
    }
    columns_.resize(names_.size());
    add_row();
  }

  void add_row() {
    if (cells_.size() == names_.size() + 1 && cells_.back().empty()) cells_.pop_back();
    if (columns_[0].empty() && names_.back().empty() && cells_.size() + 1 == names_.size()) {
      names_.pop_back();
      columns_.pop_back();
    }
    if (cells_.size() != names_.size()) {
      if (line_.find('"') != line_.npos) fail("a comma within quotes: write numbers without it");
      if (cells_.size() == 2 * names_.size() && line_.find('.') == line_.npos) fail(kDecimalCommas);
      fail("expected " + std::to_string(names_.size()) + " values, found " +
           std::to_string(cells_.size()));
    }
    if (unnamed_ && separator_ == ',') {
      has_point_ = has_point_ || line_.find('.') != line_.npos;
      for (size_t c = 1; c < cells_.size(); c += 2) {
        padded_ = padded_ || (cells_[c].size() > 1 && cells_[c][0] == '0');
      }
    }
    for (size_t c = 0; c < cells_.size(); ++c) {
      const auto value = cells_[c].empty() ? std::optional<double>(NAN) : number_of(cells_[c]);
      if (!value && has_decimal_commas(std::string(line_))) fail(kDecimalCommas);
      if (!value) fail("not a number: " + std::string(cells_[c].substr(0, 40)));
      columns_[c].push_back(*value);
    }
  }

  const std::string& file_;
  bool given_ = false;                       // The names do not come from the file.
  bool unnamed_ = false;                     // Nothing names the columns.
  bool has_point_ = false, padded_ = false;  // Numbers with decimal points; fractions such as 05.
  std::vector<std::string> names_, notes_, comments_;
  std::set<std::string> seen_;
  std::vector<std::vector<double>> columns_;
  std::vector<std::string_view> cells_;
  char separator_ = ',';
  std::string_view line_;
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
