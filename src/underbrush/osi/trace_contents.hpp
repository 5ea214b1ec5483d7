/// \file
/// This file sums up the contents of a trace.
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "underbrush/osi/sensor_data.hpp"
#include "underbrush/osi/trace.hpp"

namespace underbrush::osi {

/// The contents of a trace, summed over its messages.
struct TraceContents {
  size_t messages = 0, bytes = 0, most_moving = 0, stationary = 0, lanes = 0, lidars = 0;
  size_t reflections = 0, returns = 0, detections = 0, logical = 0, objects = 0, listed = 0;
  size_t stands = 0;  ///< Messages whose time is not later than that of the one before.
  std::optional<double> first_s, last_s;
  std::set<std::string> versions;  ///< The versions, such as "3.7.0" or "none".
  std::optional<uint64_t> host;
  std::set<uint64_t> moving, tracks;  ///< Numbers of objects.

  /// Adds the contents of a message.
  void add(const std::optional<Version>& version, const std::optional<Timestamp>& time);
  void add(const GroundTruth& truth);
  void add(const SensorView& view);
  void add(const SensorData& data);
};

/// Reads a trace to its end. Throws `FormatError`.
TraceContents contents_of(TraceReader& reader);

}  // namespace underbrush::osi
