/// \file
/// The options of the verb `osi`, and their table.
#pragma once
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/osi/lidar_log.hpp"
#include "underbrush/osi/replay.hpp"

namespace underbrush::osi {

/// The options of `osi`.
struct OsiOptions {
  std::string truth;  ///< File of the true objects of a log that is recorded; "" = none.
  double truth_elevation_deg = 0;
  ReplayOptions replay;
  bool without_view = false;  ///< Whether the SensorData of a replay has no SensorView.
  LidarLogOptions lidar;

  /// Throws `std::invalid_argument` for values out of range, and for options that have no effect
  /// on `action`: "info", "record", "replay" or "convert".
  void check(const std::string& action) const;
};

/// The options of `osi`. The parameters of the FMU that are options of a replay are rows of it,
/// too.
std::span<const Option<OsiOptions>> osi_options();

}  // namespace underbrush::osi
