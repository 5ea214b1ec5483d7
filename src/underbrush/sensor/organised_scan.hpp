/// \file
/// This file finds the rows (rings) and columns (firings) of an organised scan, which is a scan
/// that keeps its misses, and the directions of the misses.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/core/point_scan.hpp"
#include "underbrush/sensor/scan_motion.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::sensor {

/// A direction: azimuth counter-clockwise from x, and elevation above the x–y plane.
struct Angles {
  double azimuth_rad = 0, elevation_rad = 0;
};

/// The rows and columns of an organised scan and the directions fitted to them. In row r the
/// elevation is `elevation_rad[r]` and the azimuth is `azimuth_rad[r]` + column · `step_rad`, in
/// the beams' frame.
struct OrganisedScan {
  size_t rows = 0, columns = 0;
  bool column_major = false;  ///< Index = column · rows + row, else row · columns + column.
  double step_rad = 0;        ///< Step of azimuth, negative for clockwise rotation.
  std::vector<double> elevation_rad, azimuth_rad;  ///< The angles of each row.
  std::optional<ScanMotion>
      motion;  ///< Set if the points are motion-compensated; u = column / columns.

  size_t row(size_t i) const { return column_major ? i % rows : i / columns; }
  size_t column(size_t i) const { return column_major ? i / rows : i % columns; }
  double share(size_t column) const { return (double(column) + 0.5) / double(columns); }
  /// Returns the direction in which beam i was fired, in the frame of the points.
  Angles direction(size_t i) const;
};

/// Finds the rows and columns of a scan in which some points are (0,0,0) or not finite; gives
/// nothing if no layout fits.
///
/// It tries 16 to 128 rows and the number of channels of `sensor` (which may be null), in row-major
/// and in column-major order. A layout fits if 95 % of the returns lie within 0.15° of the median
/// elevation of their row and within one step of the row's line of azimuth over column. A cloud
/// whose beams have no common origin, such as an HDL-64E's at close range, therefore has no rows
/// and columns.
///
/// A scan that has no such layout, or one that holds only within more than half of that spread, is
/// tried again with a `ScanMotion`, because motion compensation
/// and a frame that is tilted or off the beams' origin bend the rows and the lines.
///
/// Rows with fewer than 3 returns get their elevation from the catalogue, shifted to the measured
/// rows, if `sensor` has as many channels, else from a line through the nearest rows. They get
/// their azimuth from the nearest row a multiple of four away, because Ouster staggers its rows by
/// four.
std::optional<OrganisedScan> find_organised_scan(const PointScan& scan, const Sensor* sensor);

}  // namespace underbrush::sensor
