// Access to the YAML files of sensors by key, for the sources that read them.
#pragma once
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// A YAML map whose keys must all be used.
class YamlMap {
 public:
  YamlMap(std::string file, std::string place, const YAML::Node& node,
          std::initializer_list<std::string_view> keys)
      : file_(std::move(file)), place_(std::move(place)), node_(node) {
    if (!node_.IsMap()) fail("", "expected lines of KEY: VALUE");
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      if (!entry.first.IsScalar()) fail("", "expected lines of KEY: VALUE");
      const auto key = entry.first.Scalar();
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) fail(key, "unknown key");
      if (!seen.insert(key).second) fail(key, "twice");
    }
  }

  YAML::Node child(const std::string& key) const {
    if (!node_[key]) fail(key, "missing");
    return node_[key];
  }
  bool has(const std::string& key) const { return bool(node_[key]); }

  template <class T>
  T get(const std::string& key) const {
    const YAML::Node value = child(key);
    try {
      return value.as<T>();
    } catch (const YAML::Exception&) {
      fail(key, "not the expected kind of value");
    }
  }
  template <class T>
  T get(const std::string& key, T fallback) const {
    return has(key) ? get<T>(key) : fallback;
  }

  /// The map under `key`.
  YamlMap map(const std::string& key, std::initializer_list<std::string_view> keys) const {
    return YamlMap(file_, place_.empty() ? key : place_ + "." + key, child(key), keys);
  }
  /// Reads one of the named values. Without the key it takes that of `fallback`, which may be null.
  template <class T>
  T choice(const std::string& key, std::initializer_list<std::pair<const char*, T>> values,
           const char* fallback = nullptr) const {
    const auto word = fallback ? get<std::string>(key, fallback) : get<std::string>(key);
    std::string known;
    for (const auto& [name, value] : values) {
      if (word == name) return value;
      known += std::string(known.empty() ? "" : ", ") + name;
    }
    fail(key, "must be one of " + known);
  }
  std::array<double, 2> pair(const std::string& key) const {
    const auto values = get<std::vector<double>>(key);
    if (values.size() != 2) fail(key, "needs two numbers");
    return {values[0], values[1]};
  }
  std::array<double, 2> pair(const std::string& key, const std::array<double, 2>& fallback) const {
    return has(key) ? pair(key) : fallback;
  }
  const std::string& file() const { return file_; }

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const {
    throw FormatError(file_, place_.empty() || key.empty() ? place_ + key : place_ + "." + key,
                      reason);
  }

 private:
  std::string file_, place_;
  YAML::Node node_;
};

/// Reads the pattern of the beams: kind, rates, and channels, raster or table.
void read_pattern(const YamlMap& root, Sensor& s);

/// Reads a whole file. Throws `FormatError`.
std::string text_of(const std::string& path);

}  // namespace underbrush::sensor
