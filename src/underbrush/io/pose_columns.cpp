#include "underbrush/io/pose_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/pose.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

/// The names in a line in lower case, without units in brackets and quotes. Names are divided by
/// commas or semicolons, or else by blanks.
std::vector<std::string> names_in(std::string_view line) {
  std::string text;
  bool in_unit = false;
  const bool commas = line.find_first_of(",;") != std::string_view::npos;
  for (const char c : line) {
    if (c == '[' || c == '(') in_unit = true;
    const bool divides = commas ? c == ',' || c == ';' : c == ' ' || c == '\t';
    const bool kept = std::isalnum(uint8_t(c)) || c == '_' || c == '.';
    if (!in_unit && divides) text += ' ';
    if (!in_unit && kept) text += char(std::tolower(uint8_t(c)));
    if (c == ']' || c == ')') in_unit = false;
  }
  std::vector<std::string> names;
  for (const std::string_view word : words_of(text)) names.emplace_back(word);
  return names;
}

/// The unit (s) of a column that counts the parts of a second; 0 for other columns.
double part_of_second(std::string name) {
  for (const char* end : {"onds", "ond", "s"}) {
    if (!name.ends_with(std::string("sec") + end)) continue;
    name.resize(name.size() - std::string_view(end).size());
  }
  for (const auto& [unit, seconds] :
       {std::pair("n", 1e-9), {"nano", 1e-9}, {"u", 1e-6}, {"micro", 1e-6}, {"m", 1e-3}}) {
    const std::string word = unit + std::string("sec");
    if (name == word || name.ends_with("." + word) || name.ends_with("_" + word)) return seconds;
  }
  return 0;
}

/// Which of t x y z qx qy qz qw the name means; 8 for none of these.
size_t meaning_of(const std::string& name) {
  const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
  for (const char* other :
       {"v_", "w_", "a_", "b_", "vel", "acc", "ang", "index"}) {  // rates and biases
    if (name.starts_with(other)) return 8;
  }
  const bool is_time = has("time") || has("stamp") || part_of_second(name) > 0;
  if (is_time || name == "t" || name == "sec" || name == "secs" || name == "seconds") return 0;
  const bool turns = has("q") || has("rot") || has("orient") || name.size() == 1;
  const char before = name.size() > 1 ? name[name.size() - 2] : 'q';
  const size_t imaginary = std::string_view("ijkr").find(name.back());
  if (turns && imaginary < 4 && name != "r" && (before == 'q' || before == '_')) {
    return 4 + imaginary;
  }
  const size_t axis = std::string_view("xyzw").find(name.back());
  if (axis == std::string_view::npos) return 8;
  return axis == 3 || (turns && name.size() > 1) ? 4 + axis : 1 + axis;
}

/// The columns of t x y z roll pitch yaw; nothing where they are not all named once.
std::optional<std::array<size_t, 7>> angle_columns_of(const std::vector<std::string>& names) {
  const std::array<std::vector<const char*>, 7> kNames{{{},
                                                        {"easting", "east"},
                                                        {"northing", "north"},
                                                        {"height", "altitude", "alt", "elevation"},
                                                        {"roll"},
                                                        {"pitch"},
                                                        {"yaw"}}};
  std::array<size_t, 7> columns{};
  columns.fill(names.size());
  for (size_t c = 0; c < names.size(); ++c) {
    size_t what = meaning_of(names[c]);
    if (what >= 4) what = 8;  // No quaternions, and no heading, which turns the other way.
    for (size_t k = 1; k < kNames.size(); ++k) {
      const auto is_start = [&](const char* name) { return names[c].starts_with(name); };
      if (std::ranges::any_of(kNames[k], is_start)) what = k;
    }
    if (what == 8) continue;
    if (columns[what] != names.size()) return std::nullopt;
    columns[what] = c;
  }
  const bool all = std::ranges::all_of(columns, [&](size_t c) { return c < names.size(); });
  return all ? std::optional(columns) : std::nullopt;
}

}  // namespace

std::optional<PoseColumns> pose_columns_of(std::string_view line) {
  const std::vector<std::string> names = names_in(line);
  PoseColumns columns;
  columns.fill(names.size());
  for (size_t c = 0; c < names.size(); ++c) {
    const size_t what = meaning_of(names[c]);
    if (what == 8) continue;
    // Parts of a second are the time only where no other column is.
    if (what == 0 && part_of_second(names[c]) > 0 && columns[0] != names.size()) continue;
    if (what == 0 && columns[0] < c && part_of_second(names[columns[0]]) > 0) {
      columns[0] = c;
      continue;
    }
    if (columns[what] != names.size()) return std::nullopt;
    columns[what] = c;
  }
  // The one name of eight that is not known is that of the time.
  const auto missing = std::count(columns.begin(), columns.end(), names.size());
  if (names.size() == 8 && missing == 1 && columns[0] == names.size()) {
    columns[0] = 28 - std::accumulate(columns.begin() + 1, columns.end(), size_t(0));
  }
  const bool all =
      std::all_of(columns.begin(), columns.end(), [&](size_t c) { return c < names.size(); });
  return all ? std::optional(columns) : std::nullopt;
}

std::optional<std::pair<size_t, double>> seconds_part_of(std::string_view line) {
  const std::vector<std::string> names = names_in(line);
  const std::optional<PoseColumns> columns = pose_columns_of(line);
  for (size_t c = 0; c < names.size() && columns; ++c) {
    const double unit = part_of_second(names[c]);
    if (unit > 0 && c != (*columns)[0]) return std::pair(c, unit);
  }
  return std::nullopt;
}

namespace {

/// Whether angles are in radians, by the words of their header or by their size. Without either,
/// and unless all are zero, throws `FormatError`.
bool are_radians(const std::string& file, const std::string& head, const NumberRows& numbers,
                 const std::array<size_t, 7>& at) {
  const std::string text = lower(head);
  if (text.find("rad") != text.npos) return true;
  double most = 0;
  for (const std::vector<double>& row : numbers.rows) {
    for (size_t what = 4; what < 7; ++what) most = std::max(most, std::abs(row[at[what]]));
  }
  if (text.find("deg") != text.npos || most > 2.001 * M_PI || most == 0) return false;
  throw FormatError(file, "header",
                    "are its angles radians or degrees? Say so in the header, as in yaw [rad] or "
                    "yaw [deg]");
}

}  // namespace

std::string use_angles(const std::string& file, NumberRows& numbers) {
  for (const std::string& head : numbers.heads) {
    const std::optional<std::array<size_t, 7>> at = angle_columns_of(names_in(head));
    const size_t n = numbers.rows[0].size();
    const auto is_whole = [n](const auto& row) { return row.size() == n; };
    if (!at || std::ranges::max(*at) >= n || !std::ranges::all_of(numbers.rows, is_whole)) continue;
    const bool radians = are_radians(file, head, numbers, *at);
    const double unit = radians ? 1 : M_PI / 180;
    for (std::vector<double>& row : numbers.rows) {
      const auto about = [&](size_t what, const Vec3& axis) {
        return Eigen::AngleAxisd(unit * row[(*at)[what]], axis);
      };
      const Eigen::Quaterniond q(about(6, Vec3::UnitZ()) * about(5, Vec3::UnitY()) *
                                 about(4, Vec3::UnitX()));
      row = {row[(*at)[0]], row[(*at)[1]], row[(*at)[2]], row[(*at)[3]],
             q.x(),         q.y(),         q.z(),         q.w()};
    }
    numbers.heads.clear();
    return std::string("the poses' rotations are roll, pitch and yaw in ") +
           (radians ? "radians" : "degrees");
  }
  return "";
}

bool names_positions(std::string_view line, size_t columns) {
  const std::vector<std::string> names = names_in(line);
  const auto has = [&](size_t what) {
    return std::any_of(names.begin(), names.end(),
                       [=](const std::string& name) { return meaning_of(name) == what; });
  };
  return names.size() == columns && has(1) && has(2) && has(3);
}

}  // namespace underbrush::io
