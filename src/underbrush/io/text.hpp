/// \file
/// Numbers and words in text files.
#pragma once
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::io {

/// The words of a line, separated by spaces and tabs; a carriage return at its end is left out.
std::vector<std::string_view> words_of(std::string_view line);
/// The whole word as a number (nan and inf are numbers), or nothing.
std::optional<double> number_of(std::string_view word);

/// Calls `f(number, line)` for each line of a text, numbers from 1, without its end; a last empty
/// one is left out.
template <class F>
void for_each_line(std::string_view text, F f) {
  size_t number = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    f(++number, text.substr(at, end - at));
    at = end + 1;
  }
}

/// A text file of numbers: one row a line, separated by spaces, tabs or commas. Empty lines and
/// those that begin with # are left out, and so is a first line that does not begin with a number.
struct NumberRows {
  std::vector<std::vector<double>> rows;
  std::vector<size_t> line;  ///< Of each row, from 1.
};
/// Throws `FormatError` where a word is not a finite number.
NumberRows read_numbers(const std::filesystem::path& path);

/// Seconds since 1970 (UTC) from "YYYY-MM-DD hh:mm:ss.nnnnnnnnn", or nothing.
std::optional<double> time_of_date(std::string_view text);

}  // namespace underbrush::io
