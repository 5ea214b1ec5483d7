/// \file
/// Point files of any format as tables of columns, and the scans that they hold.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::io {

/// Columns of equal length, in the file's order. 64-bit integers are read as double.
struct Table {
  std::vector<std::pair<std::string, ExtraColumn>> columns;
  std::optional<Pose> viewpoint;   ///< Viewpoint of a PCD file, unless it is the identity.
  std::vector<std::string> notes;  ///< Assumptions of the reader, one line each.

  size_t size() const;
  /// Returns the first column with one of these names (letter case and a leading "scalar_" do not
  /// matter), or nullptr.
  const ExtraColumn* find(const std::vector<std::string>& names) const;
  /// The step to which x, y or z are rounded where they are largest, if they are 32-bit floats;
  /// else 0. In the unit of the coordinates.
  double step() const;
  /// Returns the first of these names that a column has; "" if none does.
  std::string name_of(const std::vector<std::string>& names) const;
};

/// Reads a PCD file (ascii, binary or binary_compressed). A field with COUNT n > 1 becomes the
/// columns NAME_0 … NAME_n−1. This and the other readers throw `FormatError` for anything that is
/// not a whole file of their format.
Table read_pcd(const std::filesystem::path& path);
/// Reads a .bin file of 32-bit floats: KITTI's x y z intensity; also with a ring (nuScenes), and a
/// time behind it (Boreas). The number of columns is the one of 4 to 6 with which the fourth is an
/// intensity, the fifth a ring, and rows resemble each other most. `names` gives the columns
/// instead. Throws `FormatError`, also where the number stays unknown or is that of other columns,
/// and where the values are not 32-bit floats.
Table read_bin(const std::filesystem::path& path, const std::vector<std::string>& names = {});
/// Reads a .npy file, or a .npz file (not compressed) with one array, which is structured or of
/// shape (n, 3 to 5) with the columns x y z intensity ring. Throws `FormatError`.
Table read_numpy(const std::filesystem::path& path);
/// Reads a text file with a header line and cells separated by comma, semicolon, tab or spaces.
/// Without a header the first three columns are x y z, unless `names` gives them. A line with the
/// number of points alone is left out. Empty fields become NaN. Columns of whole numbers become
/// int32 or uint32, all others double. Throws `FormatError`.
Table read_csv(const std::filesystem::path& path, const std::vector<std::string>& names = {});
/// Reads a file in the format that its extension names: .ply .pcd .bin .npy .npz .csv .txt .xyz.
/// `names` are those of the columns of a format that has none. Throws `FormatError`.
Table read_table(const std::filesystem::path& path, const std::vector<std::string>& names = {});
/// Whether `read_table` knows the extension of `path`.
bool is_table_file(const std::filesystem::path& path);

/// Whether the extension is that of a recording: bags, LAS, captures, E57.
bool is_recording(const std::filesystem::path& path);
/// The error for a recording that the program itself does not read.
inline constexpr const char* kRecording =
    "is a recording, which the Python package of Underbrush reads: pip install "
    "'underbrush[formats]', whose command takes it";

/// The reason for which points are skipped that are nowhere near the sensor.
inline constexpr const char* kFarFromSensor = "farther than 1000 km from the sensor";
/// The question in errors about points that seem to be those of a world.
inline constexpr const char* kWorldCoordinates =
    "are its coordinates those of the world? Then --poses must say where the sensor stood, and "
    "--points-in-world";

class PointTimes;

/// The data besides a table that make it a scan.
struct ScanContext {
  ScanInfo info;
  bool points_in_world = false;  ///< x y z are in the world frame, else in the sensor's.
  double unit_m = 1;             ///< Unit of x y z, m.
  PointTimes* times = nullptr;   ///< The unit of the points' times; null = it follows from this
                                 ///< scan alone.
};

/// Turns a table into a scan. Columns are found by name: x y z; intensity or remission; a time
/// (`time_names`); ring, row, channel or laser_id. The unit of times is that of `PointTimes`.
/// All other columns become extra columns, without a leading "scalar_". An intensity that is not
/// finite becomes 0, and coordinates beyond 10⁶ m become NaN; both are counted in `skipped`. Throws
/// `FormatError`, naming `file`, where x, y or z is missing, there are no rows, or all points are
/// as far from the sensor as only coordinates of a world are.
PointScan scan_from_table(const std::string& file, Table table, const ScanContext& context,
                          std::map<std::string, size_t>& skipped);

}  // namespace underbrush::io
