#include "underbrush/perception/object_csv.hpp"

#include <algorithm>
#include <charconv>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/perception/object_columns.hpp"

namespace underbrush::perception {
namespace {

constexpr std::array<std::string_view, 7> kBox{"x", "y", "z", "yaw", "length", "width", "height"};

// The shortest text that is read as the same number.
void add_number(double value, std::string& text) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

std::string header() {
  std::string text = "time,available";
  for (const char* column : kPoseColumns) text += std::string(",") + column;
  text += ",id,truth_id,class,measured,points";
  for (const ObjectColumn& c : object_columns()) text += std::string(",") + c.name;
  for (size_t c = 1; c < kClassCount; ++c) text += ",p_" + std::string(name(ObjectClass(c)));
  return text + "\n";
}

void add_row(const ObjectList& list, TrackedObject o, std::string& text) {
  add_number(list.time_s, text);
  text += ',';
  add_number(list.available_s, text);
  for (const double v : pose_values(list.world_from_vehicle)) {
    text += ',';
    add_number(v, text);
  }
  text += ',' + std::to_string(o.id) + ',' + std::to_string(o.truth_id) + ',';
  text += name(o.label);
  text += std::string(",") + (o.is_measured ? '1' : '0') + ',' + std::to_string(o.points);
  for (const ObjectColumn& c : object_columns()) {
    text += ',';
    add_number(c.value(o), text);
  }
  for (size_t c = 1; c < kClassCount; ++c) {
    text += ',';
    add_number(double(o.probability[c]), text);
  }
  text += '\n';
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (size_t at = 0;;) {
    const size_t end = std::min(line.find(',', at), line.size());
    std::string_view cell = line.substr(at, end - at);
    while (!cell.empty() && uint8_t(cell.front()) <= ' ') cell.remove_prefix(1);
    while (!cell.empty() && uint8_t(cell.back()) <= ' ') cell.remove_suffix(1);
    cells.push_back(cell);
    if (end == line.size()) return cells;
    at = end + 1;
  }
}

}  // namespace

bool is_of_box(std::string_view column) {
  return std::find(kBox.begin(), kBox.end(), column) != kBox.end();
}

std::string csv_of(std::span<const ObjectList> lists) {
  std::string text = header();
  for (const ObjectList& list : lists) {
    if (list.objects.empty()) add_row(list, {}, text);
    for (const TrackedObject& o : list.objects) add_row(list, o, text);
  }
  return text;
}

CsvWords::CsvWords(const std::filesystem::path& path)
    : path_(path.string()), text_(read_file(path)) {
  io::for_each_line(text_, [&](size_t number, std::string_view line) {
    if (line.find_first_not_of(" \t\r") == line.npos || line.front() == '#') return;
    const auto cells = cells_of(line);
    if (names_.empty()) {
      names_ = cells;
      columns_ = cells.size();
      return;
    }
    line_.push_back(number);
    if (cells.size() != columns_) {
      fail(rows_, "expected " + std::to_string(columns_) + " values, found " +
                      std::to_string(cells.size()));
    }
    cells_.insert(cells_.end(), cells.begin(), cells.end());
    ++rows_;
  });
  if (names_.empty()) throw FormatError(path_, "", "an empty file");
}

std::optional<size_t> CsvWords::find(std::string_view name) const {
  const auto at = std::find(names_.begin(), names_.end(), name);
  if (at == names_.end()) return std::nullopt;
  return size_t(at - names_.begin());
}

size_t CsvWords::at(std::string_view name) const {
  const auto column = find(name);
  if (!column) throw FormatError(path_, "line 1", "no column " + std::string(name));
  return *column;
}

void CsvWords::fail(size_t row, const std::string& reason) const {
  throw FormatError(path_, "line " + std::to_string(line_[row]), reason);
}

double CsvWords::number(size_t row, size_t column) const {
  const auto value = io::number_of(word(row, column));
  if (!value || !std::isfinite(*value)) {
    fail(row, "column " + std::string(names_[column]) +
                  ": not a finite number: " + in_quotes(word(row, column)));
  }
  return *value;
}

uint64_t CsvWords::count(size_t row, size_t column) const {
  const double value = number(row, column);
  if (value < 0 || value > 0x1p53 || value != std::floor(value)) {
    fail(row, "column " + std::string(names_[column]) + ": not a whole number");
  }
  return uint64_t(value);
}

ObjectClass CsvWords::label(size_t row, size_t column) const {
  const auto label = class_of_name(word(row, column));
  if (!label) fail(row, "unknown class " + in_quotes(word(row, column)));
  return *label;
}

std::vector<ObjectList> read_object_csv(const std::filesystem::path& path) {
  const CsvWords csv(path);
  const size_t time = csv.at("time"), id = csv.at("id");
  std::vector<std::pair<const ObjectColumn*, size_t>> values;
  for (const ObjectColumn& c : object_columns()) {
    const auto column = is_of_box(c.name) ? csv.at(c.name) : csv.find(c.name);
    if (column) values.emplace_back(&c, *column);
  }
  std::vector<ObjectList> lists;
  for (size_t row = 0; row < csv.rows(); ++row) {
    const double time_s = csv.number(row, time);
    if (lists.empty() || time_s != lists.back().time_s) {
      if (!lists.empty() && time_s < lists.back().time_s) csv.fail(row, "times must ascend");
      ObjectList list;
      list.time_s = list.available_s = time_s;
      if (const auto c = csv.find("available")) list.available_s = csv.number(row, *c);
      if (csv.find(kPoseColumns[0])) {
        std::array<double, 7> v{};
        for (size_t k = 0; k < v.size(); ++k) v[k] = csv.number(row, csv.at(kPoseColumns[k]));
        const auto pose = pose_of_values(v);
        if (!pose) csv.fail(row, "the quaternion's length is not 1");
        list.world_from_vehicle = *pose;
      }
      lists.push_back(std::move(list));
    }
    TrackedObject o;
    o.id = csv.count(row, id);
    if (o.id == 0) continue;
    if (const auto c = csv.find("truth_id")) o.truth_id = csv.count(row, *c);
    if (const auto c = csv.find("class")) o.label = csv.label(row, *c);
    if (const auto c = csv.find("measured")) o.is_measured = csv.count(row, *c) != 0;
    if (const auto c = csv.find("points")) o.points = uint32_t(csv.count(row, *c));
    for (const auto& [column, at] : values) column->value(o) = csv.number(row, at);
    for (size_t k = 1; k < kClassCount; ++k) {
      if (const auto c = csv.find("p_" + std::string(name(ObjectClass(k))))) {
        o.probability[k] = float(csv.number(row, *c));
      }
    }
    lists.back().objects.push_back(o);
  }
  return lists;
}

}  // namespace underbrush::perception
