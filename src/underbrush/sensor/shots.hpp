/// \file
/// The shots of sensors that do not spin: one cycle of directions that repeats.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace underbrush::sensor {

/// One beam of a cycle, in the sensor's frame.
struct Shot {
  double azimuth_rad = 0;  ///< Counter-clockwise from forward.
  double elevation_rad = 0;
  double time_s = 0;  ///< Since the start of the cycle.
  uint16_t ring = 0;  ///< Row, layer or channel.
};

/// Rows of beams, evenly spaced, one shot after the other at an even rate.
struct Raster {
  double azimuth_from_rad = 0, azimuth_to_rad = 0;
  double elevation_from_rad = 0, elevation_to_rad = 0;
  uint32_t columns = 0, rows = 0;  ///< First and last at the bounds; ring = row.
  bool by_columns = false;         ///< Column after column instead of row after row.
  bool serpentine = false;         ///< Every second line runs backwards.

  uint64_t size() const { return uint64_t(columns) * rows; }
  /// Place of the k-th shot; its time is not set.
  Shot shot(uint64_t k) const;
};

/// Shots from a CSV text: azimuth_deg, elevation_deg, then time_us (rising, from 0) and ring, which
/// may be left out: then the shots are evenly spaced over `cycle_s` and of ring 0. Separated by
/// commas, tabs or spaces; a first line that does not begin with a number, empty lines and lines
/// that begin with # are left out. Throws `FormatError`, naming `file`.
std::vector<Shot> shots_from_csv(std::string_view file, std::string_view text, double cycle_s);

}  // namespace underbrush::sensor
