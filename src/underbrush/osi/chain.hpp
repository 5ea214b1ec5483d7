/// \file
/// This file has the chain of strategies from a SensorView to SensorData.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "underbrush/osi/strategy.hpp"

namespace underbrush::osi {

/// The strategies of a chain, in order.
struct ChainFile {
  std::vector<StrategyEntry> strategies;

  /// Sets a parameter of all strategies of this name. Returns whether there is one.
  bool set(const std::string& strategy, const std::string& key, const std::string& value);
};

/// Reads a chain from a YAML file, whose keys are in docs/reference/osi.md. Paths of libraries,
/// worlds and sensors are relative to the file's folder. Throws `FormatError`.
ChainFile read_chain(const std::string& path);
/// The chain front_end, alignment, tracking, classification, grid, without parameters.
ChainFile default_chain();
/// The default chain behind a tracer, for a ground truth without reflections: an Ibeo LUX 2010 at
/// the vehicle's front, 3.7 m before and 0.3 m above the rear axle.
ChainFile traced_chain();

/// Strategies that are run one after the other.
class Chain {
 public:
  /// Throws as `make_strategy` does.
  explicit Chain(const ChainFile& file);

  /// Processes a view, and returns all that the strategies have filled in. Throws `FormatError` and
  /// `DataError`.
  SensorData step(std::shared_ptr<const SensorView> view);
  /// Processes data that an earlier chain has begun.
  void step(SensorData& data);
  void reset();
  /// A copy that goes on as the original does.
  Chain clone() const;

 private:
  Chain() = default;
  std::vector<std::unique_ptr<Strategy>> strategies_;
};

/// The data of a view before any strategy: its time, the virtual sensor, and the host vehicle.
SensorData begin_data(std::shared_ptr<const SensorView> view);
/// The output of a sensor model that has no data: the time, and headers "not available".
SensorData no_data(const std::optional<Timestamp>& time);

}  // namespace underbrush::osi
