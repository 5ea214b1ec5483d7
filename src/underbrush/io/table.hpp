/// \file
/// A point file of any format as a table of columns, and the scan in it.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/point_scan.hpp"

namespace underbrush::io {

/// Columns of equal length in the file's order; 64-bit integers come as double.
struct Table {
  std::vector<std::pair<std::string, ExtraColumn>> columns;
  std::optional<Pose> viewpoint;  ///< Of a PCD file that gives one besides the identity.

  size_t size() const;
  /// The column of one of these names (letter case and a leading "scalar_" ignored), or nullptr.
  const ExtraColumn* find(const std::vector<std::string>& names) const;
};

/// A column as doubles.
std::vector<double> doubles_of(const ExtraColumn& column);

/// Readers by format. All throw `FormatError` for anything that is not a whole file of the format.
/// PCD: ascii, binary, binary_compressed. Fields with COUNT n > 1 become NAME_0 … NAME_n−1.
Table read_pcd(const std::filesystem::path& path);
/// KITTI's .bin: float32 x y z intensity.
Table read_kitti_bin(const std::filesystem::path& path);
/// .npy, or .npz (stored, not compressed) with one array: structured, or of shape (n, 3 to 5) with
/// columns x y z intensity ring.
Table read_numpy(const std::filesystem::path& path);
/// Text with a header line; separated by comma, semicolon, tab or spaces. Empty fields are NaN.
/// Columns of whole numbers come as int32 or uint32, all others as double.
Table read_csv(const std::filesystem::path& path);
/// The format is chosen by the file's extension: .ply .pcd .bin .npy .npz .csv .txt .xyz.
Table read_table(const std::filesystem::path& path);
/// Whether `read_table` knows the extension.
bool is_table_file(const std::filesystem::path& path);

/// What is said of a table besides its columns.
struct ScanContext {
  ScanInfo info;
  bool points_in_world = false;  ///< x y z are in the world frame; else in the sensor's.
};

/// The scan in a table. Columns are taken by name: x y z; intensity or remission; time (t, time,
/// timestamp, time_stamp, stamp, time_offset, timeOffset: integers are ns, others s; a scan with a
/// value above 100 s is absolute, else relative to the scan's time); ring, row or channel. All
/// others are kept as extra columns without a leading "scalar_". An intensity that is not finite
/// becomes 0 and coordinates beyond 10⁶ m become NaN; both are counted in `skipped`. Throws
/// `FormatError`, naming `file`, where x, y or z is missing or there are no rows.
PointScan scan_from_table(const std::string& file, Table table, const ScanContext& context,
                          std::map<std::string, size_t>& skipped);

}  // namespace underbrush::io
