/// \file
/// Shell completion, made from the definitions of the options.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace underbrush::app {

class Program;

/// The completion script of `shell` ("bash", "zsh" or "fish") for a program: its verbs, their
/// options, and the words of a choice; file names wherever a file is taken. Throws
/// `std::invalid_argument` for another shell.
std::string completion_script(const CLI::App& program, const std::string& shell);

/// Adds the verb `completion SHELL`.
void add_completion(Program& program);

}  // namespace underbrush::app
