#include "underbrush/io/driver_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kMark = "underbrush.json";

struct Layout {
  const char *fields, *sizes, *types;
};
constexpr Layout kLayouts[] = {
    {"x y z intensity ring time", "4 4 4 4 2 4", "F F F F U F"},
    {"x y z intensity t reflectivity ring ambient range", "4 4 4 4 4 2 2 2 4", "F F F F U U U U U"},
    {"x y z intensity return_type channel azimuth elevation distance time_stamp",
     "4 4 4 1 1 2 4 4 4 4", "F F F U U U F F F U"}};

std::string header_of(DriverLayout driver, size_t width, size_t height) {
  const Layout& layout = kLayouts[size_t(driver)];
  std::string count;
  for (const char* c = layout.fields; *c; ++c) {
    if (*c == ' ') count += " 1";
  }
  return std::string("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS ") +
         layout.fields + "\nSIZE " + layout.sizes + "\nTYPE " + layout.types + "\nCOUNT 1" + count +
         "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA binary\n";
}

template <class T>
void put(char*& out, T value) {
  std::memcpy(out, &value, sizeof(T));
  out += sizeof(T);
}

/// Rounds a value and clamps it to the range of the type.
template <class T>
T whole(double value) {
  return T(std::clamp(std::round(value), 0.0, double(std::numeric_limits<T>::max())));
}

/// A point in the sensor's frame.
struct Point {
  Vec3f at = Vec3f::Zero();
  double range_m = 0, after_s = 0;
  float intensity = 0;
  uint16_t ring = 0;
  uint8_t return_type = 1;
};

void put_point(DriverLayout driver, const Point& p, char*& out) {
  for (int c = 0; c < 3; ++c) put(out, p.at[c]);
  const auto ns = whole<uint32_t>(p.after_s * 1e9);
  switch (driver) {
    case DriverLayout::kVelodyne:
      put(out, p.intensity);
      put(out, p.ring);
      put(out, float(p.after_s));
      return;
    case DriverLayout::kOuster:
      put(out, p.intensity);
      put(out, ns);
      put(out, whole<uint16_t>(double(p.intensity)));
      put(out, p.ring);
      put(out, uint16_t(0));
      put(out, whole<uint32_t>(p.range_m * 1e3));
      return;
    case DriverLayout::kAutoware:
      put(out, whole<uint8_t>(double(p.intensity)));
      put(out, p.return_type);
      put(out, p.ring);
      put(out, std::atan2(p.at.y(), p.at.x()));
      put(out, std::atan2(p.at.z(), std::hypot(p.at.x(), p.at.y())));
      put(out, float(p.range_m));
      put(out, ns);
      return;
  }
}

/// Returns a column as whole numbers; empty if the log has none of that name.
std::vector<uint8_t> small_numbers(const BeamLog& log, const char* name) {
  const auto found = log.extra.find(name);
  if (found == log.extra.end()) return {};
  return std::visit(
      [](const auto& c) {
        std::vector<uint8_t> out(c.size());
        std::transform(c.begin(), c.end(), out.begin(), [](auto v) { return uint8_t(v); });
        return out;
      },
      found->second);
}

/// Returns the return types, numbered as in Autoware's pointcloud_preprocessor.
std::vector<uint8_t> return_types(const BeamLog& log) {
  const std::vector<uint8_t> echo = small_numbers(log, kEchoColumn),
                             echoes = small_numbers(log, kEchoesColumn);
  std::vector<uint8_t> type(log.size(), 1);
  if (echo.empty() || echoes.empty()) return type;
  for (size_t i = 0; i < log.size(); ++i) {
    if (echo[i] != 1 || echoes[i] < 2 || i + echoes[i] > log.size()) continue;
    const size_t last = i + echoes[i] - 1;
    const bool first_wins = log.intensity[i] >= log.intensity[last];
    std::fill(type.begin() + long(i), type.begin() + long(last), uint8_t(0));
    type[i] = first_wins ? 3 : 5;
    type[last] = first_wins ? 6 : 4;
  }
  return type;
}

/// The points of a scan, each in the frame that the sensor has at its firing. The pose of a time is
/// kept until another one is asked for.
class Points {
 public:
  /// What is passed by reference must outlive it.
  Points(const BeamLog& scan, const ScanInfo& info, const Trajectory& path)
      : scan_(scan), info_(info), path_(path) {}

  Point at(size_t i) {
    Point p;
    p.after_s = scan_.time_s[i] - info_.time_s;
    p.ring = scan_.ring[i];
    if (!scan_.is_hit(i)) return p;
    p.intensity = scan_.intensity[i];
    p.range_m = double(scan_.range_m[i]);
    if (scan_.time_s[i] != posed_at_s_) {
      posed_at_s_ = scan_.time_s[i];
      sensor_from_world_ = path_.at(posed_at_s_).value_or(info_.world_from_sensor).inverse();
    }
    p.at = (sensor_from_world_ * scan_.end_point(i)).cast<float>();
    return p;
  }

 private:
  const BeamLog& scan_;
  const ScanInfo& info_;
  const Trajectory& path_;
  double posed_at_s_ = std::numeric_limits<double>::quiet_NaN();
  Pose sensor_from_world_;
};

/// The number of beams of each ring.
std::vector<size_t> beams_of_rings(const BeamLog& scan) {
  std::vector<size_t> count;
  for (const uint16_t ring : scan.ring) {
    if (ring >= count.size()) count.resize(size_t(ring) + 1);
    ++count[ring];
  }
  return count;
}

/// Returns the beams of an organised cloud, ring by ring; empty where rings differ in length.
std::vector<size_t> organised(const BeamLog& scan, const std::vector<size_t>& beams_of_ring) {
  std::vector<size_t> next, order(scan.size());
  const size_t width = *std::ranges::max_element(beams_of_ring);
  size_t begin = 0;
  for (const size_t beams : beams_of_ring) {
    if (beams != 0 && beams != width) return {};
    next.push_back(begin);
    begin += beams;
  }
  for (size_t i = 0; i < scan.size(); ++i) order[next[scan.ring[i]]++] = i;
  const auto is_before = [&](size_t a, size_t b) { return scan.time_s[a] < scan.time_s[b]; };
  for (auto ring = order.begin(); ring != order.end(); ring += long(width)) {
    if (std::is_sorted(ring, ring + long(width), is_before)) continue;
    std::stable_sort(ring, ring + long(width), is_before);
  }
  return order;
}

class DriverFolder {
 public:
  DriverFolder(const fs::path& folder, const LogInfo& info, DriverLayout driver,
               const Trajectory& path)
      : folder_(folder), driver_(driver), path_(path) {
    std::vector<StampedPose> poses;
    for (const ScanInfo& s : info.scans) {
      scans_[s.scan] = s;
      poses.push_back({s.time_s, s.world_from_sensor});
    }
    if (path_.empty() && info.deskewed) path_ = Trajectory(std::move(poses));
    times_.open(folder / "times.txt");
    poses_.open(folder / "poses.txt");
    times_.precision(17);
    poses_.precision(17);
  }

  void write(const BeamLog& chunk) {
    for (size_t begin = 0; begin < chunk.size();) {
      size_t end = begin;
      while (end < chunk.size() && chunk.scan[end] == chunk.scan[begin]) ++end;
      if (!scan_.empty() && scan_.scan[0] != chunk.scan[begin]) finish();
      if (scan_.empty()) scan_ = chunk.like();
      scan_.append(chunk, begin, end);
      begin = end;
    }
  }

  void close() {
    if (!scan_.empty()) finish();
    if (!times_.flush() || !poses_.flush()) throw IoError(folder_.string() + ": cannot write");
  }

 private:
  void finish() {
    const auto found = scans_.find(scan_.scan[0]);
    require(found != scans_.end(), "export: a beam's scan has no pose");
    require(done_.insert(found->first).second, "export: a scan is not in one piece");
    const ScanInfo& info = found->second;
    const DriverCloud cloud = driver_cloud(std::move(scan_), driver_, info, path_);
    const std::string bytes = header_of(driver_, cloud.width, cloud.height) + cloud.points;
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.pcd", done_.size() - 1);
    OutputFile file(folder_ / name, (folder_ / name).string());
    file.append(bytes.data(), bytes.size());
    file.close();
    times_ << info.time_s << "\n";
    poses_ << info.time_s << " " << info.world_from_sensor.translation.transpose() << " "
           << info.world_from_sensor.rotation.coeffs().transpose() << "\n";
    scan_ = {};
  }

  fs::path folder_;
  DriverLayout driver_;
  Trajectory path_;
  std::map<uint32_t, ScanInfo> scans_;
  std::set<uint32_t> done_;
  BeamLog scan_;  ///< The scan that is being collected.
  std::ofstream times_, poses_;
};

}  // namespace

DriverLayout driver_layout_from_name(const std::string& name) {
  if (name == "velodyne") return DriverLayout::kVelodyne;
  if (name == "ouster") return DriverLayout::kOuster;
  if (name == "autoware") return DriverLayout::kAutoware;
  throw std::invalid_argument("no profile " + in_quotes(name) + ": velodyne, ouster or autoware");
}

DriverCloud driver_cloud(BeamLog scan, DriverLayout driver, const ScanInfo& info,
                         const Trajectory& world_from_sensor) {
  constexpr size_t kPoints = 4096;  // a task's
  std::vector<size_t> order;
  size_t rings = 0;
  if (driver == DriverLayout::kOuster && !scan.empty()) {
    keep_first_echoes(scan);
    const std::vector<size_t> beams_of_ring = beams_of_rings(scan);
    order = organised(scan, beams_of_ring);
    rings = beams_of_ring.size() - size_t(std::ranges::count(beams_of_ring, 0u));
  }
  const bool whole = !order.empty();
  for (size_t i = 0; i < scan.size() && !whole; ++i) {
    if (scan.is_hit(i)) order.push_back(i);
  }
  const std::vector<uint8_t> type = return_types(scan);
  DriverCloud out;
  out.height = whole ? rings : 1;
  out.width = order.size() / out.height;
  size_t step = 0;
  for (const CloudField& f : fields_of(driver)) step += f.bytes;
  out.points.resize(order.size() * step);
  parallel_for(order.size(), kPoints, [&](size_t begin, size_t end) {
    Points points(scan, info, world_from_sensor);
    char* to = out.points.data() + begin * step;
    for (size_t k = begin; k < end; ++k) {
      Point p = points.at(order[k]);
      p.return_type = type[order[k]];
      put_point(driver, p, to);
    }
  });
  return out;
}

std::vector<CloudField> fields_of(DriverLayout driver) {
  const Layout& layout = kLayouts[size_t(driver)];
  std::istringstream names(layout.fields), sizes(layout.sizes), types(layout.types);
  std::vector<CloudField> out;
  char type = 0;
  for (CloudField f; names >> f.name && sizes >> f.bytes && types >> type;) {
    f.is_float = type == 'F';
    out.push_back(f);
  }
  return out;
}

void export_driver_layout(const fs::path& path, BeamSource& source, DriverLayout driver,
                          const Trajectory& world_from_sensor, const std::string& provenance) {
  if (fs::exists(path) && !fs::exists(path / kMark) && !fs::is_empty(path)) {
    throw IoError(path.string() +
                  ": cannot write: exists and is not ours; remove it or name another");
  }
  source.rewind();
  write_atomically(
      path,
      [&](const fs::path& temporary) {
        make_temporary_folders(temporary);
        DriverFolder folder(temporary, source.info(), driver, world_from_sensor);
        for (BeamLog chunk; source.next(chunk);) folder.write(chunk);
        folder.close();
        std::ofstream mark(temporary / kMark);
        mark << (provenance.empty() ? "{}" : provenance) << "\n";
        if (!mark.flush()) throw IoError(path.string() + ": cannot write");
      },
      OutputKind::kFolder);
}

std::string lost_in(const std::string& format) {
  if (format == "pcd") return "misses, origins of the beams";
  if (format == "kitti") {
    return "misses, rings, times of the points, echo numbers, pulse widths, origins of the beams";
  }
  if (format == "velodyne") return "misses, echo numbers, pulse widths";
  if (format == "ouster") return "echoes after the first, pulse widths";
  if (format == "autoware") return "misses, echo numbers (but return types), pulse widths";
  return {};
}

}  // namespace underbrush::io
