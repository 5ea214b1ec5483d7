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
  std::optional<Pose> viewpoint;  ///< Viewpoint of a PCD file, unless it is the identity.

  size_t size() const;
  /// Returns the first column with one of these names (letter case and a leading "scalar_" do not
  /// matter), or nullptr.
  const ExtraColumn* find(const std::vector<std::string>& names) const;
};

/// Converts a column to doubles.
std::vector<double> doubles_of(const ExtraColumn& column);

/// Reads a PCD file (ascii, binary or binary_compressed). A field with COUNT n > 1 becomes the
/// columns NAME_0 … NAME_n−1. This and the other readers throw `FormatError` for anything that is
/// not a whole file of their format.
Table read_pcd(const std::filesystem::path& path);
/// Reads KITTI's .bin: float32 x y z intensity. Throws `FormatError`.
Table read_kitti_bin(const std::filesystem::path& path);
/// Reads a .npy file, or a .npz file (not compressed) with one array, which is structured or of
/// shape (n, 3 to 5) with the columns x y z intensity ring. Throws `FormatError`.
Table read_numpy(const std::filesystem::path& path);
/// Reads a text file with a header line and cells separated by comma, semicolon, tab or spaces.
/// Empty fields become NaN. Columns of whole numbers become int32 or uint32, all others double.
/// Throws `FormatError`.
Table read_csv(const std::filesystem::path& path);
/// Reads a file in the format that its extension names: .ply .pcd .bin .npy .npz .csv .txt .xyz.
/// Throws `FormatError`.
Table read_table(const std::filesystem::path& path);
/// Whether `read_table` knows the extension of `path`.
bool is_table_file(const std::filesystem::path& path);

/// What is said of a recording of ROS.
inline constexpr const char* kRecording =
    "a rosbag recording, which is not read: write its point clouds as PCD or PLY files first, one "
    "a "
    "scan (pcl_ros bag_to_pcd, or the Python package rosbags)";

/// What must be known to turn a table into a scan.
struct ScanContext {
  ScanInfo info;
  bool points_in_world = false;  ///< x y z are in the world frame, else in the sensor's.
};

/// Turns a table into a scan. Columns are found by name: x y z; intensity or remission; the time t,
/// time, timestamp, time_stamp, stamp, time_offset or timeOffset; ring, row or channel. Integer
/// times are ns, others s; times above 100 s are absolute, else they count from the scan's time.
/// All other columns become extra columns, without a leading "scalar_". An intensity that is not
/// finite becomes 0, and coordinates beyond 10⁶ m become NaN; both are counted in `skipped`. Throws
/// `FormatError`, naming `file`, where x, y or z is missing or there are no rows.
PointScan scan_from_table(const std::string& file, Table table, const ScanContext& context,
                          std::map<std::string, size_t>& skipped);

}  // namespace underbrush::io
