/// \file
/// `--config FILE.yaml` for every verb, and `dump-config VERB`.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace underbrush::app {

class Program;

/// Configurations as YAML: a flat map of a verb's options, lists for options of several values,
/// true or false for flags.
class YamlConfig : public CLI::Config {
 public:
  /// `root` is the program; the file is of the verb that it has parsed, or of itself without verbs.
  explicit YamlConfig(const CLI::App& root) : root_(root) {}

  /// The options of a verb with their defaults and what they are for.
  std::string to_config(const CLI::App* verb, bool defaults, bool descriptions,
                        std::string prefix) const override;
  /// Throws `FormatError` for a file that is not such a map, or that names an option which the verb
  /// does not have.
  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

 private:
  const CLI::App& root_;
};

/// Adds the verb `dump-config`.
void add_dump_config(Program& program);

}  // namespace underbrush::app
