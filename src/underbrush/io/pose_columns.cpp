#include "underbrush/io/pose_columns.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

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

/// Which of t x y z qx qy qz qw the name means; 8 for none of these.
size_t meaning_of(const std::string& name) {
  const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
  for (const char* other : {"v_", "w_", "a_", "b_"}) {  // velocities, rates and biases
    if (name.starts_with(other)) return 8;
  }
  if (has("time") || has("stamp") || name == "t" || name == "sec" || name == "seconds") return 0;
  const size_t axis = std::string_view("xyzw").find(name.back());
  if (axis == std::string_view::npos) return 8;
  const bool turns = has("q") || has("rot") || has("orient") || axis == 3;
  return turns ? 4 + axis : 1 + axis;
}

}  // namespace

std::optional<PoseColumns> pose_columns_of(std::string_view line) {
  const std::vector<std::string> names = names_in(line);
  PoseColumns columns;
  columns.fill(names.size());
  for (size_t c = 0; c < names.size(); ++c) {
    const size_t what = meaning_of(names[c]);
    if (what == 8) continue;
    if (columns[what] != names.size()) return std::nullopt;
    columns[what] = c;
  }
  const bool all =
      std::all_of(columns.begin(), columns.end(), [&](size_t c) { return c < names.size(); });
  return all ? std::optional(columns) : std::nullopt;
}

}  // namespace underbrush::io
