/// \file
/// The lines of the verbs' reports: a label and a text.
#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace underbrush::app {

/// Returns a line whose text begins behind a label that is padded to `width` characters.
template <class... Args>
std::string wide_line(int width, std::string_view label, fmt::format_string<Args...> text,
                      Args&&... args) {
  return fmt::format("  {:<{}} {}\n", label, width, fmt::format(text, std::forward<Args>(args)...));
}

/// Returns a line with a label of the usual width.
template <class... Args>
std::string line(std::string_view label, fmt::format_string<Args...> text, Args&&... args) {
  return wide_line(11, label, text, std::forward<Args>(args)...);
}

/// Returns the lines about the folder of a set of primitives.
inline std::string lines_of_set(const std::filesystem::path& folder) {
  return line("primitives", "{}", folder.string()) +
         line("to look at", "{}", (folder / "index.html").string());
}

/// Returns a line with the number of things that were left out; none for 0.
inline std::string left_out(size_t n, std::string_view what) {
  return n ? line("left out", "{} {}", n, what) : "";
}

}  // namespace underbrush::app
