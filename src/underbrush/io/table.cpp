#include "underbrush/io/table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/ply_header.hpp"

namespace underbrush::io {
namespace {

constexpr double kFarthest = 1e6;       // m from the sensor
constexpr double kNearest = 1e-5;       // m; nearer points have no direction
constexpr double kLongestOffset = 100;  // s; a larger time is not an offset within a scan

std::string without_prefix(const std::string& name) {
  return name.rfind("scalar_", 0) == 0 ? name.substr(7) : name;
}

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(uint8_t(c)));
  return text;
}

using Column = std::pair<std::string, ExtraColumn>;

// Takes the first column with one of these names out of the table.
std::optional<ExtraColumn> take(Table& table, const std::vector<std::string>& names) {
  const ExtraColumn* found = table.find(names);
  if (!found) return std::nullopt;
  const auto at = std::find_if(table.columns.begin(), table.columns.end(),
                               [&](const Column& c) { return &c.second == found; });
  ExtraColumn out = std::move(at->second);
  table.columns.erase(at);
  return out;
}

void fill_points(const std::string& file, Table& table, const ScanContext& context, PointScan& scan,
                 std::map<std::string, size_t>& skipped) {
  std::array<std::vector<double>, 3> xyz;
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, char('x' + c));
    const auto column = take(table, {name});
    if (!column) throw FormatError(file, "header", "no column '" + name + "'");
    xyz[size_t(c)] = doubles_of(*column);
  }
  const size_t n = xyz[0].size();
  const Pose sensor_from_world = context.info.world_from_sensor.inverse();
  size_t absurd = 0;
  scan.point.resize(n);
  for (size_t i = 0; i < n; ++i) {
    Vec3 p(xyz[0][i], xyz[1][i], xyz[2][i]);
    if (context.points_in_world) p = sensor_from_world * p;
    if (p.allFinite() && p.cwiseAbs().maxCoeff() > kFarthest) {
      ++absurd;
      p.setConstant(NAN);
    }
    // Such a point has no direction and counts as a miss.
    if (p.squaredNorm() < kNearest * kNearest) p.setZero();
    scan.point[i] = p.cast<float>();
  }
  if (absurd) skipped[kFarFromSensor] += absurd;
}

void fill_times(Table& table, PointScan& scan) {
  const auto column = take(table, {"t", "time", "timestamp", "time_stamp", "stamp", "time_offset",
                                   "timeoffset", "gps_time", "gpstime"});
  if (!column) return;
  scan.time_s = doubles_of(*column);
  double largest = 0;
  if (type_of(*column) < ValueType::kF32) {
    for (double& t : scan.time_s) t *= 1e-9;
  }
  for (const double t : scan.time_s) {
    if (std::isfinite(t)) largest = std::max(largest, std::abs(t));
  }
  // A 64-bit count of nanoseconds was read as double.
  if (largest > 1e15) {
    for (double& t : scan.time_s) t *= 1e-9;
  }
  if (largest > kLongestOffset) return;
  for (double& t : scan.time_s) t += scan.info.time_s;
}

void fill_rings(Table& table, PointScan& scan) {
  const ExtraColumn* column = table.find({"ring", "row", "channel"});
  if (!column) return;
  const std::vector<double> values = doubles_of(*column);
  const bool whole = std::all_of(values.begin(), values.end(), [](double v) {
    return v >= 0 && v <= 65535 && v == std::floor(v);
  });
  if (!whole) return;  // The column means something else and stays an extra column.
  scan.ring.assign(values.begin(), values.end());
  take(table, {"ring", "row", "channel"});
}

}  // namespace

size_t Table::size() const { return columns.empty() ? 0 : length_of(columns[0].second); }

const ExtraColumn* Table::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    for (const auto& [key, column] : columns) {
      if (lower(without_prefix(key)) == name) return &column;
    }
  }
  return nullptr;
}

std::vector<double> doubles_of(const ExtraColumn& column) {
  return std::visit([](const auto& c) { return std::vector<double>(c.begin(), c.end()); }, column);
}

Table read_kitti_bin(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  constexpr size_t kRow = 16;
  if (bytes.size() % kRow != 0) {
    throw FormatError(path.string(), "byte " + std::to_string(bytes.size() / kRow * kRow),
                      "a point is 16 bytes, the file ends inside one: truncated");
  }
  Table table;
  for (size_t c = 0; c < 4; ++c) {
    constexpr const char* kNames[] = {"x", "y", "z", "intensity"};
    std::vector<float> column(bytes.size() / kRow);
    for (size_t i = 0; i < column.size(); ++i) {
      column[i] = load<float>(bytes.data() + i * kRow + 4 * c);
    }
    table.columns.emplace_back(kNames[c], std::move(column));
  }
  return table;
}

bool is_table_file(const std::filesystem::path& path) {
  const std::string ext = lower(path.extension().string());
  for (const char* known : {".ply", ".pcd", ".bin", ".npy", ".npz", ".csv", ".txt", ".xyz"}) {
    if (ext == known) return true;
  }
  return false;
}

Table read_table(const std::filesystem::path& path) {
  const std::string ext = lower(path.extension().string());
  if (ext == ".pcd") return read_pcd(path);
  if (ext == ".bin") return read_kitti_bin(path);
  if (ext == ".npy" || ext == ".npz") return read_numpy(path);
  if (ext == ".csv" || ext == ".txt" || ext == ".xyz") return read_csv(path);
  if (ext != ".ply") {
    const bool recording = ext == ".bag" || ext == ".db3" || ext == ".mcap";
    const bool las = ext == ".las" || ext == ".laz";
    throw FormatError(path.string(), "",
                      recording ? kRecording
                      : las ? "LAS and LAZ are not read: convert it to PLY or CSV, with x y z as "
                              "double"
                            : "unknown kind of file: " + in_quotes(ext) +
                                  "; known are .ply .pcd .bin .npy .npz .csv .txt .xyz");
  }
  PlyData data = read_ply(path);
  for (PlyElement& element : data.elements) {
    if (element.name == "vertex") return {std::move(element.columns), std::nullopt};
  }
  throw FormatError(path.string(), "header", "no element 'vertex'");
}

PointScan scan_from_table(const std::string& file, Table table, const ScanContext& context,
                          std::map<std::string, size_t>& skipped) {
  PointScan scan;
  scan.info = context.info;
  if (table.size() == 0) throw FormatError(file, "", "an empty scan: no points");
  fill_points(file, table, context, scan, skipped);
  fill_times(table, scan);
  fill_rings(table, scan);
  scan.intensity.assign(scan.size(), 0);
  if (const auto column = take(table, {"intensity", "remission", "i"})) {
    size_t bad = 0;
    const std::vector<double> values = doubles_of(*column);
    for (size_t i = 0; i < values.size(); ++i) {
      const float value = float(values[i]);
      if (std::isfinite(value)) {
        scan.intensity[i] = value;
      } else if (scan.point[i].allFinite()) {
        ++bad;
      }
    }
    if (bad) skipped["intensity not finite (set to 0, beam kept)"] += bad;
  }
  for (auto& [name, column] : table.columns) {
    scan.extra[without_prefix(name)] = std::move(column);
  }
  return scan;
}

}  // namespace underbrush::io
