/// \file
/// The reference of a program's command line, generated from the definitions of its options.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace underbrush::app {

/// Returns a page of Markdown with every verb and its options.
std::string command_line_page(const CLI::App& program);
/// Returns the manual page (section 1) as roff.
std::string manual_page(const CLI::App& program, const std::string& version);

}  // namespace underbrush::app
