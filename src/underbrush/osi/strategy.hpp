/// \file
/// This file has the strategies: exchangeable steps from the reflections of a lidar to a list of
/// objects, as [rosenberger20] §4 has them in an FMU. A strategy has only OSI's SensorData and its
/// own parameters.
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/osi/sensor_data.hpp"

namespace underbrush::osi {

/// A step of the chain. Its state is that of the cycles so far.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// Processes one cycle: reads what earlier strategies have filled in, and fills in its own part.
  /// Throws `DataError` for data that it cannot work with; its state is then as before or that of
  /// the cycle.
  virtual void step(SensorData& data) = 0;
  /// Forgets all cycles.
  virtual void reset() = 0;
  /// A copy that goes on as the original does.
  virtual std::unique_ptr<Strategy> clone() const = 0;
};

/// The entry of a strategy in a chain's file.
struct StrategyEntry {
  std::string name;     ///< One of `strategy_names()`, or any name with a library.
  std::string library;  ///< Path of a shared library of the user's; "" = ours.
  std::map<std::string, std::string> parameters;
  std::string file, place;  ///< The file and the place of the entry, for errors.
};

/// A parameter of a strategy, for people to read.
struct StrategyParameter {
  std::string key, fallback;  ///< Its name and its default.
  std::string values;         ///< The allowed values; "" = any text.
};

/// The parameters of an entry, by name. All functions throw `FormatError`, which names the place,
/// for a value of the wrong kind or out of range.
class Parameters {
 public:
  explicit Parameters(const StrategyEntry& entry) : entry_(entry) {}
  double number(const std::string& key, double fallback, double least, double most);
  uint64_t count(const std::string& key, uint64_t fallback, uint64_t most);
  bool flag(const std::string& key, bool fallback);
  std::string text(const std::string& key, const char* fallback);
  /// Returns the index of the value among several words.
  size_t choice(const std::string& key, const std::vector<std::string_view>& words);
  /// Sets an option from the parameter of its name, which has `_` for `-` and ends with the unit.
  template <class T>
  void set(const Option<T>& option, T& options) {
    std::string key(option.name);
    std::replace(key.begin(), key.end(), '-', '_');
    const std::string unit = "_" + std::string(option.unit);
    if (unit.size() > 1 && !key.ends_with(unit)) key += unit;
    std::visit(
        [&](const auto field) {
          auto& place = field(options);
          using Value = std::decay_t<decltype(place)>;
          if constexpr (std::is_same_v<Value, bool>) {
            place = flag(key, place);
          } else if constexpr (std::is_same_v<Value, std::string>) {
            place = std::string(option.choices[choice(key, option.choices)]);
          } else if constexpr (std::is_floating_point_v<Value>) {
            place = number(key, place, option.least, option.most);
          } else if constexpr (std::is_arithmetic_v<Value>) {
            place = Value(count(key, uint64_t(place), uint64_t(option.most)));
          }
        },
        option.field);
  }
  /// Throws where the entry has a parameter that was not asked for.
  void finish() const;
  /// The parameters that were asked for, in this order.
  const std::vector<StrategyParameter>& known() const { return known_; }
  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;

 private:
  const std::string* find(const StrategyParameter& parameter);
  const StrategyEntry& entry_;
  std::vector<StrategyParameter> known_;
};

/// The sensor of a tracer unless another is given.
inline constexpr const char* kTracedSensor = "ibeo-lux-2010";
/// The names of our strategies, in the order in which a chain has them.
const std::vector<std::string>& strategy_names();
/// The parameters of one of our strategies.
std::vector<StrategyParameter> parameters_of(const std::string& strategy);
/// Makes a strategy. Throws `FormatError` for an unknown name or wrong parameters.
std::unique_ptr<Strategy> make_strategy(const StrategyEntry& entry);

}  // namespace underbrush::osi
