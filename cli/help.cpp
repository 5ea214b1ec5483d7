#include "cli/help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <sstream>

namespace underbrush::app {
namespace {

constexpr size_t kWidth = 80, kTextColumn = 26;

/// Counts the characters, not the bytes, of UTF-8 text.
size_t width_of(std::string_view text) {
  return size_t(std::count_if(text.begin(), text.end(),
                              [](char c) { return (static_cast<uint8_t>(c) & 0xc0) != 0x80; }));
}

/// Breaks `text` into lines of at most `kWidth` columns. The first line begins at column `at`; the
/// others are indented by `indent`.
std::string wrapped(const std::string& text, size_t at, size_t indent) {
  std::istringstream words(text);
  std::string out;
  bool first = true;
  for (std::string word; words >> word; first = false) {
    if (!first && at + 1 + width_of(word) > kWidth) {
      out += "\n" + std::string(indent, ' ');
      at = indent;
    } else if (!first) {
      out += " ";
      ++at;
    }
    out += word;
    at += width_of(word);
  }
  return out;
}

/// Writes an entry of a list: a name, with the text beside or below it.
std::string entry(const std::string& name, const std::string& text) {
  std::string line = "  " + name;
  if (width_of(line) + 2 > kTextColumn) {
    line += "\n" + std::string(kTextColumn, ' ');
  } else {
    line += std::string(kTextColumn - width_of(line), ' ');
  }
  return line + wrapped(text, kTextColumn, kTextColumn) + "\n";
}

/// Returns the kind of value that an option takes; empty for a flag.
std::string value_name(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return "";
  std::string type = option.get_type_name();
  for (const char* check : {":{", ":FLOAT in", ":INT in", ":UINT in", ":POSITIVE", ":NONNEGATIVE",
                            ":DIR(", ":FILE(", ":PATH("}) {
    type = type.substr(0, type.find(check));  // CLI11 appends what it checks
  }
  if (type == "INT" || type == "UINT") type = "N";
  if (type == "FLOAT") type = "X";
  if (type == "TEXT" || type.empty()) type = option.get_positional() ? "" : "NAME";
  return type;
}

std::string group_text(const std::string& title, const std::vector<const CLI::Option*>& options) {
  std::string out = "\n" + title + ":\n";
  for (const CLI::Option* o : options) out += entry(written(*o), described(*o));
  return out;
}

}  // namespace

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const size_t begin = type.find('{'), end = type.find('}');
  std::vector<std::string> words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::istringstream list(type.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

std::string written(const CLI::Option& option) {
  if (!option.nonpositional()) return option.get_single_name();
  std::string names;
  for (const std::string& s : option.get_snames()) names += (names.empty() ? "-" : ", -") + s;
  for (const std::string& l : option.get_lnames()) names += (names.empty() ? "--" : ", --") + l;
  const std::string value = value_name(option);
  return value.empty() ? names : names + " " + value;
}

std::string described(const CLI::Option& option) {
  std::string text = option.get_description();
  const std::vector<std::string> choices = choices_of(option);
  if (!choices.empty()) text += fmt::format("; one of {}", fmt::join(choices, ", "));
  if (option.get_required() && option.nonpositional()) text += " (required)";
  std::string value = option.get_default_str();
  if (option.get_expected_max() <= 0 || value.empty()) return text;
  if (value.front() != '[') return text + fmt::format(" [{}]", value);
  std::replace(value.begin(), value.end(), ',', ' ');  // of a list
  return text + " " + value;
}

std::vector<const CLI::App*> verbs_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* a) { return !a->get_name().empty(); });
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name,
                                     CLI::AppFormatMode mode) const {
  if (mode == CLI::AppFormatMode::Sub) {
    const std::string verb = app->get_parent()->get_name() + " " + app->get_name();
    return "\n" + make_usage(app, verb) + make_positionals(app) + groups(app, mode);
  }
  return wrapped(app->get_description(), 0, 0) + "\n\n" + make_usage(app, std::move(name)) +
         make_positionals(app) + groups(app, mode) + make_subcommands(app, mode) + "\n" +
         make_footer(app);
}

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  std::string line = "Usage: " + (name.empty() ? app->get_name() : name);
  for (const CLI::Option* o : app->get_options()) {
    if (!o->nonpositional()) {
      const std::string word = o->get_single_name() + (o->get_expected_max() > 1 ? " ..." : "");
      line += o->get_required() ? " " + word : " [" + word + "]";
    } else if (o->get_required()) {
      const std::string s = o->get_snames().empty() ? "" : o->get_snames().front();
      line += (s.empty() ? " --" + o->get_lnames().front() : " -" + s) + " " + value_name(*o);
    }
  }
  if (!app->get_subcommands({}).empty()) line += " VERB";
  return line + " [OPTIONS]\n";
}

std::string HelpFormatter::make_positionals(const CLI::App* app) const {
  const auto options = app->get_options([](const CLI::Option* o) { return !o->nonpositional(); });
  std::string out = options.empty() ? "" : "\n";
  for (const CLI::Option* o : options) out += entry(written(*o), described(*o));
  return out;
}

std::string HelpFormatter::groups(const CLI::App* app, CLI::AppFormatMode mode) const {
  std::string out;
  size_t left_out = 0, unlisted = 0;
  std::vector<std::string> titles = app->get_groups();
  std::stable_partition(titles.begin(), titles.end(),
                        [](const std::string& title) { return title != kCommonGroup; });
  for (const std::string& group : titles) {
    auto options = app->get_options(
        [&](const CLI::Option* o) { return o->nonpositional() && o->get_group() == group; });
    if (group == kUnlistedGroup) unlisted += options.size();
    if (group.empty() || group == kUnlistedGroup || options.empty()) continue;
    if (mode == CLI::AppFormatMode::Normal && hidden_.count(group)) {
      left_out += options.size();
      continue;
    }
    const CLI::App* root = app->get_parent();
    if (group == kCommonGroup && root) options.push_back(root->get_config_ptr());
    out += group_text(group, options);
  }
  if (left_out > 0) {
    const std::string program = app->get_parent() ? app->get_parent()->get_name() + " " : "";
    out += fmt::format("\n{} more options: {}{} --help-all\n", left_out, program, app->get_name());
  } else if (unlisted > 0) {
    out += fmt::format(
        "\n{} more options serve configurations of papers: docs/reference/parameters.md\n",
        unlisted);
  }
  return out;
}

std::string HelpFormatter::make_subcommand(const CLI::App* sub) const {
  return entry(sub->get_name(), sub->get_description());
}

}  // namespace underbrush::app
