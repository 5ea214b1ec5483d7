#include "yaml_config.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include "underbrush/core/check.hpp"

namespace underbrush::app {
namespace {

// Options that name a run's files or belong to one call are left out of a configuration.
bool configurable(const CLI::Option& option) {
  static const std::vector<std::string> kOfOneCall = {"help", "json", "output", "config"};
  return !option.get_lnames().empty() && !option.get_required() &&
         std::find(kOfOneCall.begin(), kOfOneCall.end(), option.get_lnames().front()) ==
             kOfOneCall.end();
}

bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0; }

void dump(const CLI::App& verb, std::ostream& out) {
  for (const CLI::Option* option : verb.get_options()) {
    if (!configurable(*option)) continue;
    const std::string name = option->get_lnames().front(), value = option->get_default_str();
    out << "# " << option->get_description() << "\n";
    if (is_flag(*option)) {
      out << name << ": false\n";
    } else {
      out << (value.empty() ? "# " : "") << name << ": " << value << "\n";
    }
  }
}

YAML::Node read(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw FormatError(file, "", "cannot be read");
  YAML::Node root;
  try {
    root = YAML::Load(in);
  } catch (const YAML::Exception& e) {
    throw FormatError(file, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
  if (!root.IsNull() && !root.IsMap()) throw FormatError(file, "", "expected lines of NAME: VALUE");
  return root;
}

/// One entry of a configuration as words of a command line.
std::vector<std::string> words_of(const std::string& file, const std::string& name,
                                  const YAML::Node& value, const CLI::Option& option) {
  if (!value.IsScalar() && !value.IsSequence()) {
    throw FormatError(file, name, "expected a value or a list of values");
  }
  if (is_flag(option)) {
    const std::string text = value.IsScalar() ? value.Scalar() : "";
    if (text != "true" && text != "false") throw FormatError(file, name, "expected true or false");
    return text == "true" ? std::vector<std::string>{"--" + name} : std::vector<std::string>{};
  }
  std::vector<std::string> words;
  if (value.IsScalar()) return {"--" + name + "=" + value.Scalar()};
  words.push_back("--" + name);
  for (const auto& item : value) words.push_back(item.as<std::string>());
  return words;
}

bool given(const std::vector<std::string>& words, const CLI::Option& option) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    const auto& longs = option.get_lnames();
    const auto& shorts = option.get_snames();
    return (name.starts_with("--") &&
            std::find(longs.begin(), longs.end(), name.substr(2)) != longs.end()) ||
           (name.size() == 2 && name[0] == '-' &&
            std::find(shorts.begin(), shorts.end(), name.substr(1)) != shorts.end());
  });
}

}  // namespace

void add_config(CLI::App& root) {
  for (CLI::App* verb : root.get_subcommands({})) {
    verb->add_option("--config", "Read options from a YAML file; flags override it")
        ->type_name("FILE.yaml");
  }
  CLI::App* verb = root.add_subcommand(
      "dump-config",
      "Print the options of a verb with their defaults, to start a --config file from");
  auto name = std::make_shared<std::string>();
  verb->add_option("VERB", *name, "The verb")->required();
  verb->footer("Example:\n  underbrush dump-config fit > fit.yaml");
  verb->callback([&root, name] {
    for (const CLI::App* other : root.get_subcommands({})) {
      if (other->get_name() == *name) return dump(*other, std::cout);
    }
    throw std::invalid_argument("dump-config: no verb '" + *name + "'");
  });
}

std::vector<std::string> with_config(const CLI::App& root, int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  std::string file;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--config" && i + 1 < words.size()) file = words[i + 1];
    if (words[i].starts_with("--config=")) file = words[i].substr(9);
  }
  if (file.empty() || words.empty()) return words;
  const auto verbs =
      root.get_subcommands([&](const CLI::App* a) { return a->get_name() == words[0]; });
  if (verbs.empty()) return words;
  const auto options =
      verbs.front()->get_options([](const CLI::Option* o) { return configurable(*o); });
  std::vector<std::string> added;
  for (const auto& entry : read(file)) {
    const std::string name = entry.first.as<std::string>();
    const auto option = std::find_if(options.begin(), options.end(), [&](const CLI::Option* o) {
      return o->get_lnames().front() == name;
    });
    if (option == options.end()) {
      throw FormatError(file, name, "no such option of '" + words[0] + "' (see dump-config)");
    }
    if (given(words, **option)) continue;
    for (std::string& w : words_of(file, name, entry.second, **option))
      added.push_back(std::move(w));
  }
  // Behind the others: an option with a list of values would take the words that follow it.
  words.insert(words.end(), added.begin(), added.end());
  return words;
}

}  // namespace underbrush::app
