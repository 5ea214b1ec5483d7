/// \file
/// This file finds the returns of a scan that belong to one pulse.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::sensor {

/// The reason for which later returns are skipped.
inline constexpr const char* kNoPulse = "later return whose first return is not there";

/// A scan of pulses with several returns.
struct PulseReturns {
  /// The first return of each pulse, and every point that is no return. The extra columns
  /// `kEchoColumn` and `kEchoesColumn` replace those of the file.
  PointScan first;
  /// A later return of a pulse.
  struct Later {
    uint32_t first = 0;  ///< Index of its pulse in `first`.
    float range_m = 0;   ///< Range from the sensor's origin.
    float intensity = 0;
    uint8_t echo = 0;  ///< 2, 3, … in order of range.
  };
  std::vector<Later> later;  ///< In the order of `first`, then of range.
  size_t lost = 0;           ///< Later returns without a first one.
};

/// Separates the returns of pulses by the columns of their number (`target_index`,
/// `return_number`) and count (`target_count`, `number_of_returns`). Gives nothing for a scan
/// without both. A later return belongs to the first one of its own
/// time, or, in a scan without times, to the nearest in direction of those that are nearer to the
/// sensor and whose pulse has as many returns, within 1 mrad.
std::optional<PulseReturns> pulse_returns(const PointScan& scan);

/// Inserts the later returns behind the first ones. `beams` are those of `pulses.first`, with the
/// extra column `kPulseColumn`, which is removed; beams that are no returns of it are misses.
void insert_later_returns(const PulseReturns& pulses, BeamLog& beams);

/// The index in `PulseReturns::first`, as an extra column of it.
inline constexpr const char* kPulseColumn = "_pulse";

}  // namespace underbrush::sensor
