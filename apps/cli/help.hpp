/// \file
/// How `--help` and `--help-all` look.
#pragma once
#include <CLI/CLI.hpp>
#include <set>
#include <string>
#include <vector>

namespace underbrush::app {

/// The group of the options that all verbs have; help texts show it last.
inline constexpr const char* kCommonGroup = "Common";

/// Help texts of 80 columns: usage, positionals, options by group, verbs by stage. The values of a
/// choice and the default stand behind what an option is for.
class HelpFormatter : public CLI::Formatter {
 public:
  /// Leaves the options of this group to `--help-all`.
  void hide(const std::string& group) { hidden_.insert(group); }

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_positionals(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* sub) const override;

 private:
  std::string groups(const CLI::App* app, CLI::AppFormatMode mode) const;

  std::set<std::string> hidden_;
};

/// The words that an option may take, or none where any will do.
std::vector<std::string> choices_of(const CLI::Option& option);
/// The option as it is written: "-o, --output MODEL", "LOG", "--carve".
std::string written(const CLI::Option& option);
/// What the option is for, with its choices and its default.
std::string described(const CLI::Option& option);

}  // namespace underbrush::app
