/// \file
/// The layout of `--help` and `--help-all`.
#pragma once
#include <CLI/CLI.hpp>
#include <set>
#include <string>
#include <vector>

namespace underbrush::app {

/// The group of the options that all verbs have; help texts show it last.
inline constexpr const char* kCommonGroup = "Common";
/// The group of options that no help text lists, but the reference of parameters of a fit.
inline constexpr const char* kUnlistedGroup = "Unlisted";

/// Writes help texts of 80 columns: usage, positionals, options by group, verbs by stage. The
/// values of a choice and the default follow the help text of an option.
class HelpFormatter : public CLI::Formatter {
 public:
  /// Shows the options of this group only in `--help-all`.
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

/// Returns the values that an option may take; empty where any value will do.
std::vector<std::string> choices_of(const CLI::Option& option);
/// Returns an option as the user writes it: "-o, --output MODEL", "LOG", "--carve".
std::string written(const CLI::Option& option);
/// Returns the help text of an option with its choices and its default.
std::string described(const CLI::Option& option);
/// The verbs of a program, in the order in which they were added.
std::vector<const CLI::App*> verbs_of(const CLI::App& program);

}  // namespace underbrush::app
