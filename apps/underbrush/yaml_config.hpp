/// `--config FILE.yaml` for every verb, and `dump-config VERB`.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace underbrush::app {

/// Gives each verb the option `--config FILE.yaml` and adds the verb `dump-config`.
void add_config(CLI::App& root);

/// The command line's words, with the options of a `--config` file put in where the command line
/// does not give them itself. Throws `FormatError` for a file that cannot be read, is not a flat
/// map of options, or names an option that the verb does not have.
std::vector<std::string> with_config(const CLI::App& root, int argc, char** argv);

}  // namespace underbrush::app
