/// \file
/// This file has the shots of sensors that do not spin: a cycle of directions that repeats.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace underbrush::sensor {

/// A beam of a cycle, in the sensor's frame.
struct Shot {
  double azimuth_rad = 0;  ///< Counter-clockwise from forward.
  double elevation_rad = 0;
  double time_s = 0;  ///< Since the start of the cycle.
  uint16_t ring = 0;  ///< Row, layer or channel.
};

/// A raster: rows of evenly spaced beams that are fired one by one at a constant rate. The first
/// and the last column and row lie at the bounds.
struct Raster {
  double azimuth_from_rad = 0, azimuth_to_rad = 0;
  double elevation_from_rad = 0, elevation_to_rad = 0;
  uint32_t columns = 0, rows = 0;  ///< The ring is the row.
  bool by_columns = false;         ///< Column after column instead of row after row.
  bool serpentine = false;         ///< Every second line runs backwards.

  uint64_t size() const { return uint64_t(columns) * rows; }
  /// The direction and ring of the k-th shot. Its time is not set.
  Shot shot(uint64_t k) const;
};

/// Reads shots from a CSV text with the columns azimuth_deg, elevation_deg, time_us (rising, from
/// 0) and ring. Without the last two, shots are evenly spaced over `cycle_s` (s) and have ring 0.
/// Columns are separated by commas, tabs or spaces. Empty lines, lines that begin with # and a
/// first line that does not begin with a number are ignored. Throws `FormatError`, which names
/// `file`.
std::vector<Shot> shots_from_csv(std::string_view file, std::string_view text, double cycle_s);

}  // namespace underbrush::sensor
