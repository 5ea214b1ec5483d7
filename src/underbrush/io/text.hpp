/// \file
/// Parsers of numbers and words in text files.
#pragma once
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::io {

/// Returns the text with the letters A to Z as small ones.
std::string lower(std::string text);
/// Splits a line into words at spaces and tabs, without a carriage return at its end.
std::vector<std::string_view> words_of(std::string_view line);
/// Parses the whole word as a number (nan and inf are numbers); nothing if it is none.
std::optional<double> number_of(std::string_view word);

/// Calls `f(number, line)` for each line of a text. Numbers count from 1; the line comes without
/// its end. An empty last line is left out.
template <class F>
void for_each_line(std::string_view text, F f) {
  size_t number = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    f(++number, text.substr(at, end - at));
    at = end + 1;
  }
}

/// Reads a whole text file, without the byte order mark that Windows editors put before UTF-8.
/// Throws `FormatError`, also for UTF-16, and where it is longer than `limit` bytes.
std::string read_text(const std::filesystem::path& path, uint64_t limit);

/// Rows of numbers in a text file, separated by spaces, tabs or commas. Empty lines and lines that
/// begin with # are left out, as is a first line that does not begin with a number.
struct NumberRows {
  std::vector<std::vector<double>> rows;
  std::vector<size_t> line;        ///< Line number of each row, from 1.
  std::vector<std::string> heads;  ///< The comments and names above the first row.
};
/// Reads a text file of numbers. Throws `FormatError` where a word is not a finite number.
NumberRows read_numbers(const std::filesystem::path& path);

/// Parses "YYYY-MM-DD hh:mm:ss.nnnnnnnnn" into seconds since 1970 (UTC); nothing for any other
/// text.
std::optional<double> time_of_date(std::string_view text);

}  // namespace underbrush::io
