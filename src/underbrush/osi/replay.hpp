/// \file
/// This file runs a chain of strategies on the messages of a trace.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/static_data.hpp"
#include "underbrush/osi/trace.hpp"

namespace underbrush::osi {

/// The options of a replay. A text is empty where it is not given.
struct ReplayOptions {
  std::string chain;                    ///< File of a chain.
  std::vector<std::string> strategies;  ///< Each is NAME[:KEY=VALUE,...].
  std::string sensor, world;            ///< The tracer takes both, the front end the sensor.
  std::string actors;                   ///< Folder of the models of movers, for the tracer.
  uint64_t seed = 1;                    ///< The seed of our strategies that have none in the chain.
};

/// Makes the chain of the options. Without a chain and strategies it is the default one, behind a
/// tracer if a world is given or `is_truth`: the messages have no reflections. Throws
/// `std::invalid_argument` for options that do not fit, and as `read_chain` and `Chain` do.
Chain chain_of(const ReplayOptions& options, bool is_truth);

/// A trace whose messages a chain processes one after the other.
class Replay {
 public:
  /// The reader must outlive this, and stands at its beginning. Throws as `chain_of` does.
  Replay(TraceReader& reader, const ReplayOptions& options);
  /// Replaces `data` by the result of the chain for the next message. Returns false at the end.
  /// Throws `FormatError`.
  bool next(SensorData& data);

 private:
  TraceReader& reader_;
  Chain chain_;
  StaticData known_;
};

}  // namespace underbrush::osi
