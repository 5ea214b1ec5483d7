#include "underbrush/io/table.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

constexpr double kFarthest = 1e6;  // m from the sensor
constexpr double kNearest = 1e-5;  // m; nearer points have no direction

std::string without_prefix(const std::string& name) {
  return name.rfind("scalar_", 0) == 0 ? name.substr(7) : name;
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

/// Refuses points that stand above each other: degrees of longitude and latitude, and heights.
void check_not_degrees(const std::string& file, const std::array<std::vector<double>, 3>& xyz) {
  constexpr size_t kEnough = 20;
  constexpr double kAside = 0.01, kUp = 0.5;  // degrees; m
  std::array<double, 3> extent{};
  for (size_t c = 0; c < 3; ++c) {
    const auto [low, high] = std::ranges::minmax_element(xyz[c]);
    if (xyz[c].size() < kEnough || (c < 2 && (*low == *high || std::abs(*low) > 180))) return;
    extent[c] = *high - *low;
  }
  if (!(extent[0] < kAside && extent[1] < kAside && extent[2] > kUp)) return;
  throw FormatError(file, "",
                    "x and y of its points lie within 0.01: are they degrees of longitude and "
                    "latitude? Then project them to m");
}

/// Points whose distance is many times their extent were measured from elsewhere.
void check_around_sensor(const std::string& file, const std::vector<Vec3f>& points) {
  constexpr float kLeastFar = 300, kExtent = 0.3f;  // m; of the distance
  constexpr size_t kEnough = 20;
  Vec3f low = Vec3f::Constant(INFINITY), high = -low;
  float nearest = INFINITY;
  size_t n = 0;
  for (const Vec3f& p : points) {
    if (!p.allFinite() || p.isZero()) continue;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    nearest = std::min(nearest, p.norm());
    ++n;
  }
  if (n < kEnough || nearest < kLeastFar || (high - low).norm() > kExtent * nearest) return;
  throw FormatError(file, "",
                    "its points lie " + std::to_string(int(nearest)) + " m and more from the " +
                        "sensor but only " + std::to_string(int((high - low).norm())) +
                        " m apart; " + kWorldCoordinates);
}

/// Whether a table has directions and ranges in place of coordinates.
bool is_spherical(const Table& table) {
  return table.find({"azimuth"}) && table.find({"range", "distance", "r"});
}

/// What is missing, and the columns that are there.
std::string no_column(const std::string& file, const std::string& name, const Table& table) {
  constexpr size_t kMost = 8;
  for (const char* unit : {"mm", "cm", "ft"}) {
    if (!table.find({name + "[" + unit + "]", name + "_" + unit})) continue;
    return std::string("its coordinates are in ") + unit +
           ": name the columns and the unit, as in --columns x,y,z --unit " + unit;
  }
  if (is_spherical(table)) return "it has angles and ranges: write the points as x y z";
  std::string text = "no column '" + name + "'";
  for (size_t c = 0; c < std::min(table.columns.size(), kMost); ++c) {
    text += (c == 0 ? "; its columns are " : ", ") + printable(table.columns[c].first);
  }
  if (table.columns.size() > kMost) text += ", …";
  const std::string ext = lower(std::filesystem::path(file).extension().string());
  const bool is_text = ext == ".csv" || ext == ".txt" || ext == ".xyz";
  return text + (is_text ? ": --columns x,y,z,intensity names them" : "");
}

void fill_points(const std::string& file, Table& table, const ScanContext& context, PointScan& scan,
                 std::map<std::string, size_t>& skipped) {
  std::array<std::vector<double>, 3> xyz;
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, char('x' + c)), number = std::to_string(c);
    const auto column = take(table, {name, "points_m_xyz:" + number, "points:" + number});
    if (!column) throw FormatError(file, "header", no_column(file, name, table));
    xyz[size_t(c)] = doubles_of(*column);
  }
  check_not_degrees(file, xyz);
  const size_t n = xyz[0].size();
  const Pose sensor_from_world = context.info.world_from_sensor.inverse();
  size_t absurd = 0;
  scan.point.resize(n);
  for (size_t i = 0; i < n; ++i) {
    Vec3 p = context.unit_m * Vec3(xyz[0][i], xyz[1][i], xyz[2][i]);
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
  if (!context.points_in_world) check_around_sensor(file, scan.point);
}

void fill_times(const std::string& file, Table& table, const ScanContext& context,
                PointScan& scan) {
  const std::string name = table.name_of(time_names());
  if (name.empty()) return;
  const auto column = take(table, {name});
  PointTimes own;
  PointTimes& times = context.times ? *context.times : own;
  scan.time_s = times.seconds(file, name, *column, scan.info.time_s);
}

void fill_rings(Table& table, PointScan& scan, std::map<std::string, size_t>& skipped) {
  static const std::vector<std::string> kNames{"ring", "row", "channel", "laser_id"};
  const ExtraColumn* column = table.find(kNames);
  if (!column) return;
  const std::vector<double> values = doubles_of(*column);
  const auto others = size_t(std::count_if(values.begin(), values.end(), [](double v) {
    return !(v >= 0 && v <= 65535 && v == std::floor(v));
  }));
  if (others > 0) {  // The column means something else and stays an extra column.
    skipped["values of ring that are no whole numbers (rings not used, beams kept)"] += others;
    return;
  }
  scan.ring.assign(values.begin(), values.end());
  take(table, kNames);
}

bool has_extension(const std::filesystem::path& path, std::initializer_list<const char*> known) {
  return std::ranges::find(known, lower(path.extension().string())) != known.end();
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

double Table::step() const {
  double most = 0;
  for (const char* name : {"x", "y", "z"}) {
    const ExtraColumn* column = find({name});
    if (!column || type_of(*column) != ValueType::kF32) continue;
    for (const float v : std::get<std::vector<float>>(*column)) {
      if (std::isfinite(v)) most = std::max(most, std::abs(double(v)));
    }
  }
  return most > 0 ? std::ldexp(1.0, std::ilogb(most) - 23) : 0;
}

std::string Table::name_of(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    if (find({name})) return name;
  }
  return "";
}

bool is_table_file(const std::filesystem::path& path) {
  return has_extension(path, {".ply", ".pcd", ".bin", ".npy", ".npz", ".csv", ".txt", ".xyz"});
}

bool is_recording(const std::filesystem::path& path) {
  return has_extension(path, {".bag", ".db3", ".mcap", ".las", ".laz", ".pcap", ".pcapng", ".e57"});
}

Table read_table(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const std::string ext = lower(path.extension().string());
  if (ext == ".pcd") return read_pcd(path);
  if (ext == ".bin") return read_bin(path, names);
  if (ext == ".npy" || ext == ".npz") return read_numpy(path);
  if (ext == ".csv" || ext == ".txt" || ext == ".xyz") return read_csv(path, names);
  if (ext != ".ply") {
    if (is_recording(path)) throw FormatError(path.string(), "", kRecording);
    throw FormatError(path.string(), "",
                      "unknown kind of file: " + in_quotes(ext) +
                          "; known are .ply .pcd .bin .npy .npz .csv .txt .xyz");
  }
  PlyData data = read_ply(path);
  for (PlyElement& element : data.elements) {
    if (element.name == "vertex") return {std::move(element.columns), {}, {}};
  }
  throw FormatError(path.string(), "header", "no element 'vertex'");
}

PointScan scan_from_table(const std::string& file, Table table, const ScanContext& context,
                          std::map<std::string, size_t>& skipped) {
  PointScan scan;
  scan.info = context.info;
  if (table.size() == 0) throw FormatError(file, "", "an empty scan: no points");
  fill_points(file, table, context, scan, skipped);
  fill_times(file, table, context, scan);
  fill_rings(table, scan, skipped);
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
