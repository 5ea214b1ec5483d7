#include "cli/config.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <istream>
#include <sstream>

#include "underbrush/core/check.hpp"

namespace underbrush::app {
namespace {

// A configuration leaves out options that name a run's inputs or belong to a single call.
bool configurable(const CLI::Option& option) {
  return option.get_configurable() && !option.get_lnames().empty() && !option.get_required();
}

bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0; }

YAML::Node read(std::istream& in, const std::string& file) {
  YAML::Node root;
  try {
    root = YAML::Load(in);
  } catch (const YAML::Exception& e) {
    throw FormatError(file, "line " + std::to_string(e.mark.line + 1), e.msg);
  }
  if (!root.IsNull() && !root.IsMap()) throw FormatError(file, "", "expected lines of NAME: VALUE");
  return root;
}

std::vector<std::string> values_of(const std::string& file, const std::string& name,
                                   const YAML::Node& value, const CLI::Option& option) {
  if (!value.IsScalar() && !value.IsSequence()) {
    throw FormatError(file, name, "expected a value or a list of values");
  }
  if (is_flag(option)) {
    const std::string text = value.IsScalar() ? value.Scalar() : "";
    if (text != "true" && text != "false") throw FormatError(file, name, "expected true or false");
  }
  if (value.IsScalar()) return {value.Scalar()};
  std::vector<std::string> values;
  for (const auto& item : value) {
    if (!item.IsScalar()) throw FormatError(file, name, "expected a value or a list of values");
    values.push_back(item.Scalar());
  }
  return values;
}

}  // namespace

std::string YamlConfig::to_config(const CLI::App* verb, bool, bool, std::string) const {
  std::ostringstream out;
  for (const CLI::Option* option : verb->get_options()) {
    if (!configurable(*option)) continue;
    const std::string name = option->get_lnames().front(), value = option->get_default_str();
    out << "# " << option->get_description() << "\n";
    if (is_flag(*option)) {
      out << name << ": false\n";
    } else {
      out << (value.empty() ? "# " : "") << name << ": " << value << "\n";
    }
  }
  return out.str();
}

std::vector<CLI::ConfigItem> YamlConfig::from_config(std::istream& in) const {
  const std::string file = root_.get_config_ptr()->as<std::string>();
  const auto verbs = root_.get_subcommands();
  const CLI::App& verb = verbs.empty() ? root_ : *verbs.front();
  const auto options = verb.get_options([](const CLI::Option* o) { return configurable(*o); });
  std::vector<CLI::ConfigItem> settings;
  for (const auto& entry : read(in, file)) {
    if (!entry.first.IsScalar()) throw FormatError(file, "", "expected lines of NAME: VALUE");
    CLI::ConfigItem item;
    item.name = entry.first.as<std::string>();
    const auto option = std::find_if(options.begin(), options.end(), [&](const CLI::Option* o) {
      return o->get_lnames().front() == item.name;
    });
    if (option == options.end()) {
      throw FormatError(file, item.name,
                        "no such option of '" + verb.get_name() + "' (see dump-config)");
    }
    if (!verbs.empty()) item.parents = {verb.get_name()};
    item.inputs = values_of(file, item.name, entry.second, **option);
    if (!is_flag(**option) || item.inputs.front() == "true") settings.push_back(std::move(item));
  }
  return settings;
}

}  // namespace underbrush::app
