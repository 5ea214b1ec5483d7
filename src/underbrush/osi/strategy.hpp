/// \file
/// This file has the strategies: exchangeable steps from what a lidar receives to a list of
/// objects, as [rosenberger20] §4 has them in an FMU. A strategy sees only OSI's SensorData and its
/// own parameters.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

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

/// A strategy as a chain's file names it.
struct StrategyEntry {
  std::string name;     ///< One of `strategy_names()`, or any name with a library.
  std::string library;  ///< Path of a shared library of the user's; "" = ours.
  std::map<std::string, std::string> parameters;
  std::string file, place;  ///< Where the entry stands, for errors.
};

/// The parameters of an entry, by name. All functions throw `FormatError`, which names the place,
/// for a value of the wrong kind or out of range.
class Parameters {
 public:
  explicit Parameters(const StrategyEntry& entry) : entry_(entry) {}
  double number(const char* key, double fallback, double least, double most);
  uint64_t count(const char* key, uint64_t fallback, uint64_t most);
  bool flag(const char* key, bool fallback);
  std::string text(const char* key, const char* fallback);
  /// One of several words; returns its index.
  size_t choice(const char* key, std::initializer_list<const char*> words, size_t fallback = 0);
  /// Throws where the entry has a parameter that was not asked for.
  void finish() const;
  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;

 private:
  const std::string* find(const char* key);
  const StrategyEntry& entry_;
  std::set<std::string> known_;
};

/// The names of our strategies, in the order in which a chain has them.
const std::vector<std::string>& strategy_names();
/// Makes a strategy. Throws `FormatError` for an unknown name or wrong parameters.
std::unique_ptr<Strategy> make_strategy(const StrategyEntry& entry);

}  // namespace underbrush::osi
