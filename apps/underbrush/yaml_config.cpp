#include "yaml_config.hpp"

#include <yaml-cpp/yaml.h>

#include <iostream>
#include <sstream>

#include "underbrush/core/check.hpp"

namespace underbrush::app {
namespace {

// Options that name a run's files or belong to one call are left out of a configuration.
bool configurable(const CLI::Option& option) {
  return !option.get_lnames().empty() && option.get_configurable() && !option.get_required() &&
         option.get_lnames().front() != "json" && option.get_lnames().front() != "output";
}

/// YAML for CLI11: a flat map from option name to value or list.
class YamlConfig : public CLI::Config {
 public:
  std::string to_config(const CLI::App* app, bool, bool with_descriptions,
                        std::string) const override {
    std::ostringstream out;
    for (const CLI::Option* option : app->get_options()) {
      if (!configurable(*option)) continue;
      std::string text = option->get_description();
      for (size_t at; (at = text.find('\n')) != std::string::npos;) text.replace(at, 1, " ");
      if (with_descriptions) out << "# " << text << "\n";
      const std::string name = option->get_lnames().front(), value = option->get_default_str();
      const bool flag = option->get_expected_max() == 0;
      if (flag) {
        out << name << ": " << (value == "true" ? "true" : "false") << "\n";
      } else if (value.empty()) {
        out << "# " << name << ":\n";
      } else {
        out << name << ": " << value << "\n";
      }
    }
    return out.str();
  }

  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    std::vector<CLI::ConfigItem> found;
    YAML::Node root;
    try {
      root = YAML::Load(in);
    } catch (const YAML::Exception& e) {
      throw FormatError("configuration", "line " + std::to_string(e.mark.line + 1), e.msg);
    }
    if (root.IsNull()) return found;
    if (!root.IsMap()) throw FormatError("configuration", "", "expected lines of NAME: VALUE");
    for (const auto& entry : root) {
      CLI::ConfigItem item;
      item.name = entry.first.as<std::string>();
      if (entry.second.IsSequence()) {
        for (const auto& value : entry.second) item.inputs.push_back(value.as<std::string>());
      } else if (entry.second.IsScalar()) {
        item.inputs.push_back(entry.second.as<std::string>());
      } else {
        throw FormatError("configuration", item.name, "expected a value or a list of values");
      }
      found.push_back(std::move(item));
    }
    return found;
  }
};

}  // namespace

void add_config(CLI::App& root) {
  for (CLI::App* verb : root.get_subcommands({})) {
    verb->config_formatter(std::make_shared<YamlConfig>());
    verb->set_config("--config", "", "Read options from a YAML file; flags override it")
        ->type_name("FILE.yaml");
    verb->allow_config_extras(CLI::config_extras_mode::error);
  }
  CLI::App* dump = root.add_subcommand(
      "dump-config",
      "Print the options of a verb with their defaults, to start a --config file from");
  auto name = std::make_shared<std::string>();
  dump->add_option("VERB", *name, "The verb")->required();
  dump->footer("Example:\n  underbrush dump-config fit > fit.yaml");
  dump->callback([&root, name] {
    for (const CLI::App* verb : root.get_subcommands({})) {
      if (verb->get_name() != *name) continue;
      std::cout << verb->config_to_str(true, true);
      return;
    }
    throw std::invalid_argument("dump-config: no verb '" + *name + "'");
  });
}

}  // namespace underbrush::app
