/// \file
/// Organised clouds: the rows (rings) and columns (firings) of a scan that keeps its misses, and
/// the directions of those misses.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// An organised scan's rows and columns and the directions fitted to them: in row r, elevation =
/// `elevation_rad[r]` and azimuth = `azimuth_rad[r]` + column · `step_rad`.
struct OrganisedScan {
  size_t rows = 0, columns = 0;
  bool column_major = false;  ///< Index = column · rows + row, else row · columns + column.
  double step_rad = 0;        ///< Signed: negative for clockwise rotation.
  std::vector<double> elevation_rad, azimuth_rad;  ///< Per row.

  size_t row(size_t i) const { return column_major ? i % rows : i / columns; }
  size_t column(size_t i) const { return column_major ? i / rows : i % columns; }
};

/// The rows and columns of a scan in which some points are (0,0,0) or not finite; none if no layout
/// fits. It tries 16 to 128 rows (and the channels of `sensor`, if given), by rows and by columns;
/// a layout fits if 95 % of the returns lie within 0.15° of the median elevation of their row and
/// within one step of its line of azimuth over column (so a cloud seen far off the beams' origin,
/// as the HDL-64E's at close range, has no rows and columns). Rows with fewer than 3 returns get
/// their elevation from the catalogue, shifted to the measured rows, if `sensor` has as many
/// channels, else from the line through the nearest rows; their azimuth from the nearest row a
/// multiple of four away (Ouster staggers by four).
std::optional<OrganisedScan> find_organised_scan(const PointScan& scan, const Sensor* sensor);

}  // namespace underbrush::sensor
