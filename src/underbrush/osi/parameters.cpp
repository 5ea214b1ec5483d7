#include <algorithm>
#include <cmath>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/osi/strategies.hpp"

namespace underbrush::osi {
namespace {

struct Named {
  const char* name;
  std::unique_ptr<Strategy> (*make)(Parameters&);
};
constexpr Named kStrategies[] = {
    {"tracer", make_tracer},
    {"front_end", make_front_end},
    {"alignment", make_alignment},
    {"tracking", make_tracking},
    {"classification", make_classification},
    {"grid", make_grid},
};

std::string joined(const auto& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

}  // namespace

const std::string* Parameters::find(const StrategyParameter& parameter) {
  known_.push_back(parameter);
  const auto at = entry_.parameters.find(parameter.key);
  return at == entry_.parameters.end() ? nullptr : &at->second;
}

void Parameters::fail(const std::string& key, const std::string& reason) const {
  throw FormatError(
      entry_.file,
      entry_.place.empty() || key.empty() ? entry_.place + key : entry_.place + "." + key, reason);
}

double Parameters::number(const std::string& key, double fallback, double least, double most) {
  const auto text = [](double v) {
    std::string digits = std::to_string(v);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return digits;
  };
  const std::string range = text(least) + " to " + text(most);
  const std::string* word = find({key, std::isnan(fallback) ? "" : text(fallback), range});
  if (!word) return fallback;
  const auto value = io::number_of(*word);
  if (!value || !(*value >= least && *value <= most)) fail(key, "must be a number from " + range);
  return *value;
}

uint64_t Parameters::count(const std::string& key, uint64_t fallback, uint64_t most) {
  const double value = number(key, double(fallback), 0, double(most));
  if (value != std::floor(value)) fail(key, "must be a whole number");
  return uint64_t(value);
}

bool Parameters::flag(const std::string& key, bool fallback) {
  const std::string* word = find({key, text_of(fallback), "true or false"});
  if (!word) return fallback;
  if (*word != "true" && *word != "false") fail(key, "must be true or false");
  return *word == "true";
}

std::string Parameters::text(const std::string& key, const char* fallback) {
  const std::string* word = find({key, fallback, ""});
  return word ? *word : fallback;
}

size_t Parameters::choice(const std::string& key, const std::vector<std::string_view>& words) {
  const std::string* word = find({key, std::string(words.at(0)), joined(words)});
  if (!word) return 0;
  const auto at = std::find(words.begin(), words.end(), *word);
  if (at == words.end()) fail(key, "must be one of " + joined(words));
  return size_t(at - words.begin());
}

void Parameters::finish() const {
  std::set<std::string> names;
  for (const StrategyParameter& parameter : known_) names.insert(parameter.key);
  for (const auto& [key, value] : entry_.parameters) {
    if (!names.contains(key)) {
      fail(key, "unknown parameter of " + entry_.name + "; there are: " + joined(names));
    }
  }
}

const std::vector<std::string>& strategy_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Named& s : kStrategies) out.emplace_back(s.name);
    return out;
  }();
  return names;
}

std::vector<StrategyParameter> parameters_of(const std::string& strategy) {
  const StrategyEntry entry{strategy, "", {}, "", ""};
  Parameters parameters(entry);
  for (const Named& s : kStrategies) {
    if (strategy == s.name) s.make(parameters);
  }
  return parameters.known();
}

std::unique_ptr<Strategy> make_strategy(const StrategyEntry& entry) {
  if (!entry.library.empty()) return load_strategy(entry);
  Parameters parameters(entry);
  for (const Named& s : kStrategies) {
    if (entry.name != s.name) continue;
    try {
      auto strategy = s.make(parameters);
      parameters.finish();
      return strategy;
    } catch (const FormatError& e) {
      if (e.file() == entry.file) throw;
      parameters.fail("", e.what());  // A file that the chain names: its sensor, its world.
    }
  }
  parameters.fail("strategy", "unknown strategy; there are: " + joined(strategy_names()));
}

}  // namespace underbrush::osi
