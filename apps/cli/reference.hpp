/// \file
/// The reference of a program's command line, made from the definitions of its options.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace underbrush::app {

/// Every verb with its options, as a page of Markdown.
std::string command_line_page(const CLI::App& program);
/// The manual page, section 1, as roff.
std::string manual_page(const CLI::App& program, const std::string& version);

}  // namespace underbrush::app
