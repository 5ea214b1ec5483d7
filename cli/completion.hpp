/// \file
/// Shell completion, generated from the definitions of the options.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace underbrush::app {

class Program;

/// Returns the completion script of a program for `shell` ("bash", "zsh" or "fish"). It completes
/// verbs, their options, the values of a choice, and file names wherever a file is expected. Throws
/// `std::invalid_argument` for another shell.
std::string completion_script(const CLI::App& program, const std::string& shell);

/// Adds the verb `completion SHELL`.
void add_completion(Program& program);

}  // namespace underbrush::app
