/// \file
/// Shell completion, generated from the definitions of the options.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace underbrush::app {

class Program;

/// The suggested values of options besides files, by the long name of an option without dashes.
using Suggestions = std::map<std::string, std::vector<std::string>>;

/// Returns the completion script of a program for `shell` ("bash", "zsh" or "fish"). It completes
/// verbs, their options, the values of a choice and those of `suggestions`, and file names wherever
/// a file is expected. Throws `std::invalid_argument` for another shell.
std::string completion_script(const CLI::App& program, const std::string& shell,
                              const Suggestions& suggestions = {});

/// Adds the verb `completion SHELL`.
void add_completion(Program& program, const Suggestions& suggestions = {});

}  // namespace underbrush::app
