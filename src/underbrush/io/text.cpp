#include "underbrush/io/text.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::io {
namespace {
constexpr uint64_t kMaxText = uint64_t(1) << 31;
}

std::string lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = char(c + 32);
  }
  return text;
}

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\r\v\f";
  std::vector<std::string_view> words;
  size_t at = 0;
  while ((at = line.find_first_not_of(kSpace, at)) != std::string_view::npos) {
    const size_t end = std::min(line.find_first_of(kSpace, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<double> number_of(std::string_view word) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string read_text(const std::filesystem::path& path, uint64_t limit) {
  std::string text = read_file(path, limit);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
    throw FormatError(path.string(), "byte 0", "is text in UTF-16: save it as UTF-8");
  }
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

NumberRows read_numbers(const std::filesystem::path& path) {
  std::string text = read_text(path, kMaxText);
  for (char& c : text) {
    if (c == ',' || c == ';') c = ' ';
  }
  NumberRows out;
  for_each_line(text, [&](size_t line, std::string_view content) {
    const auto words = words_of(content);
    // The first line may be a header.
    const bool named = out.rows.empty() && line == 1 && !words.empty() && !number_of(words[0]);
    if (words.empty() || words[0][0] == '#' || named) {
      if (out.rows.empty()) out.heads.emplace_back(content);
      return;
    }
    std::vector<double> row;
    for (const auto& word : words) {
      const auto value = number_of(word);
      if (!value || !std::isfinite(*value)) {
        throw FormatError(path.string(), "line " + std::to_string(line),
                          in_quotes(word) + " is not a finite number");
      }
      row.push_back(*value);
    }
    out.rows.push_back(std::move(row));
    out.line.push_back(line);
  });
  if (out.rows.empty()) throw FormatError(path.string(), "", "no numbers in it");
  return out;
}

std::optional<double> time_of_date(std::string_view text) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
  double second = 0;
  const std::string line(text);
  if (std::sscanf(line.c_str(), "%4d-%2d-%2d %2d:%2d:%n", &year, &month, &day, &hour, &minute,
                  &used) != 5 ||
      used == 0) {
    return std::nullopt;
  }
  const auto words = words_of(std::string_view(line).substr(size_t(used)));
  const auto s = words.size() == 1 ? number_of(words[0]) : std::nullopt;
  if (!s || !(*s >= 0 && *s < 61) || month < 1 || month > 12 || day < 1 || day > 31 || hour > 23 ||
      minute > 59 || hour < 0 || minute < 0) {
    return std::nullopt;
  }
  second = *s;
  // Counts the days since 1970-01-01 in the proleptic Gregorian calendar, with years that begin in
  // March.
  const int y = month <= 2 ? year - 1 : year, era = (y >= 0 ? y : y - 399) / 400;
  const int of_era = y - era * 400,
            of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const int of_era_days = of_era * 365 + of_era / 4 - of_era / 100 + of_year;
  const double days = double(era) * 146097 + of_era_days - 719468;
  return days * 86400 + hour * 3600 + minute * 60 + second;
}

}  // namespace underbrush::io
