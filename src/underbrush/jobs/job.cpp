#include "underbrush/jobs/job.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::jobs {
namespace {

constexpr uint64_t kMostBytes = 1 << 24;
constexpr size_t kMostPieces = 1000000;
constexpr size_t kMostCommands = 1000000;

std::vector<std::string> texts_in(const YAML::Node& list) {
  std::vector<std::string> out;
  for (const YAML::Node& value : list) out.push_back(value.as<std::string>());
  return out;
}

std::vector<std::string> words_of(const YAML::Node& command) {
  if (command.IsSequence()) return texts_in(command);
  std::istringstream text(command.as<std::string>());
  return {std::istream_iterator<std::string>(text), {}};
}

void set(Job& job, const std::string& key, const YAML::Node& value) {
  if (key == "command") {
    job.command = words_of(value);
  } else if (key == "pieces") {
    job.pieces = value.as<size_t>();
    require_data(job.pieces >= 1 && job.pieces <= kMostPieces, "expected 1 to a million");
  } else if (key == "over") {
    require_data(value.IsMap(), "expected lines of NAME: [VALUES]");
    for (const auto& entry : value) {
      const std::vector<std::string> values = texts_in(entry.second);
      require_data(entry.second.IsSequence() && !values.empty(), "expected lists of values");
      job.over[entry.first.as<std::string>()] = values;
    }
  } else {
    throw DataError("unknown key; a job has command, over and pieces");
  }
}

/// Replaces each {NAME} in a word. Marks the names that it finds.
std::string filled(const std::string& word, const std::map<std::string, std::string>& values,
                   std::map<std::string, bool>& found) {
  std::string out;
  size_t at = 0;
  for (size_t open; (open = word.find('{', at)) != std::string::npos;) {
    const size_t close = word.find('}', open);
    if (close == std::string::npos) break;
    const std::string name = word.substr(open + 1, close - open - 1);
    const auto value = values.find(name);
    if (value == values.end()) {
      throw std::invalid_argument("the command has {" + printable(name) +
                                  "}, of which over has no values");
    }
    found[name] = true;
    out += word.substr(at, open - at) + value->second;
    at = close + 1;
  }
  return out + word.substr(at);
}

/// Calls a function with each key of a YAML file and its value. Throws `FormatError`.
void for_each_entry(const std::filesystem::path& path,
                    const std::function<void(const std::string&, const YAML::Node&)>& use) {
  const std::string file = path.string();
  std::string key;
  try {
    const YAML::Node root = YAML::Load(read_file(path, kMostBytes));
    require_data(root.IsMap(), "expected lines of KEY: VALUE");
    for (const auto& entry : root) {
      key = entry.first.as<std::string>();
      use(key, entry.second);
    }
  } catch (const YAML::ParserException& e) {
    throw FormatError(file, "line " + std::to_string(e.mark.line + 1), e.msg);
  } catch (const YAML::Exception&) {
    throw FormatError(file, key, "not the expected kind of value");
  } catch (const DataError& e) {
    throw FormatError(file, key, e.what());
  }
}

bool is_option(const std::string& word, const std::string& option) {
  return word == option || word.starts_with(option + "=");
}

}  // namespace

Job read_job(const std::filesystem::path& path) {
  Job job;
  for_each_entry(path,
                 [&](const std::string& key, const YAML::Node& value) { set(job, key, value); });
  if (job.command.empty()) throw FormatError(path.string(), "command", "missing");
  return job;
}

std::vector<std::vector<std::string>> commands_of(const Job& job) {
  size_t count = 1;
  for (const auto& [name, values] : job.over) {
    count *= values.size();
    require(count <= kMostCommands, "the values of over have more than a million combinations");
  }
  std::vector<std::vector<std::string>> out;
  std::map<std::string, bool> found;
  for (size_t k = 0; k < count; ++k) {
    std::map<std::string, std::string> values;
    size_t rest = k;
    for (auto name = job.over.rbegin(); name != job.over.rend(); ++name) {
      values[name->first] = name->second[rest % name->second.size()];
      rest /= name->second.size();
    }
    std::vector<std::string>& words = out.emplace_back();
    for (const std::string& word : job.command) words.push_back(filled(word, values, found));
  }
  for (const auto& [name, values] : job.over) {
    if (found[name]) continue;
    throw std::invalid_argument("over has values of " + printable(name) +
                                ", but the command has no {" + printable(name) + "}");
  }
  return out;
}

std::vector<std::string> with_settings(const std::vector<std::string>& words) {
  const std::string kConfig = "--config";
  const auto at = std::ranges::find_if(words, [&](const auto& w) { return is_option(w, kConfig); });
  std::vector<std::string> out = words;
  if (at == words.end()) return out;
  require(*at != kConfig || at + 1 != words.end(),
          "the command ends with an option without its value");
  const std::string file = *at == kConfig ? at[1] : at->substr(kConfig.size() + 1);
  for_each_entry(file, [&](const std::string& name, const YAML::Node& value) {
    const std::string option = "--" + name;
    const bool is_own =
        std::ranges::any_of(words, [&](const auto& word) { return is_option(word, option); });
    if (is_own) return;
    const auto values =
        value.IsSequence() ? texts_in(value) : std::vector<std::string>{value.as<std::string>()};
    const std::string with = option + "=";
    for (const std::string& text : values) out.push_back(with + text);
  });
  return out;
}

}  // namespace underbrush::jobs
