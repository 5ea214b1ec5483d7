/// \file
/// The option `--config FILE.yaml` of every verb.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace underbrush::app {

/// Reads and writes configurations as YAML: a flat map of a verb's options, with lists for options
/// of several values and true or false for flags.
class YamlConfig : public CLI::Config {
 public:
  /// `root` is the program. A file configures the verb that the program has parsed, or a program
  /// without verbs itself.
  explicit YamlConfig(const CLI::App& root) : root_(root) {}

  /// Returns the options of a verb with their defaults and help texts.
  std::string to_config(const CLI::App* verb, bool defaults, bool descriptions,
                        std::string prefix) const override;
  /// Parses a configuration. Throws `FormatError` for a file that is not a flat map, or that names
  /// an option which the verb does not have.
  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

 private:
  const CLI::App& root_;
};

}  // namespace underbrush::app
