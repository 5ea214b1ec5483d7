#include "underbrush/io/export.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

// File beside the data that holds the provenance.
constexpr const char* kKittiMark = "underbrush.json";

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
void put_number(std::string& out, T value, char after) {
  char text[40];
  out.append(text, size_t(std::to_chars(text, text + sizeof text, value).ptr - text));
  out += after;
}

/// Returns the names of the extra columns that can be fields of a PCD file: those without blanks.
std::vector<std::string> pcd_extras(const BeamLog& log) {
  std::vector<std::string> names;
  for (const auto& [name, column] : log.extra) {
    if (!name.empty() && name.find_first_of(" \t\n") == std::string::npos) names.push_back(name);
  }
  return names;
}

// Writes the header. The number of points is a field of twenty digits that is overwritten once it
// is known.
std::string pcd_header(size_t points, const BeamLog& log) {
  char count[32];
  std::snprintf(count, sizeof count, "%020zu", points);
  std::string fields, sizes, types, counts;
  for (const std::string& name : pcd_extras(log)) {
    std::visit(
        [&](const auto& c) {
          using T = typename std::decay_t<decltype(c)>::value_type;
          fields += " " + name;
          sizes += " " + std::to_string(sizeof(T));
          types += std::is_floating_point_v<T> ? " F" : std::is_signed_v<T> ? " I" : " U";
          counts += " 1";
        },
        log.extra.at(name));
  }
  return std::string("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n") + kPcdFields +
         fields + "\nSIZE 8 8 8 4 8 2 4 4" + sizes + "\nTYPE F F F F F U U U" + types +
         "\nCOUNT 1 1 1 1 1 1 1 1" + counts + "\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

void write_pcd(const fs::path& temporary, const std::string& name, BeamSource& source) {
  OutputFile file(temporary, name);
  std::string bytes;
  size_t points = 0;
  bool first = true;
  BeamLog columns;  // Columns of the first chunk, without beams.
  for (BeamLog chunk; source.next(chunk);) {
    if (first) {
      columns = chunk.like();
      bytes = pcd_header(0, columns);
      first = false;
    }
    const std::vector<std::string> extras = pcd_extras(columns);
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      const Vec3 end = chunk.end_point(i);
      for (int c = 0; c < 3; ++c) put(bytes, end[c]);
      put(bytes, chunk.intensity[i]);
      put(bytes, chunk.time_s[i]);
      put(bytes, chunk.ring[i]);
      put(bytes, chunk.scan[i]);
      put(bytes, chunk.packet[i]);
      for (const std::string& extra : extras) {
        std::visit([&](const auto& c) { put(bytes, c[i]); }, chunk.extra.at(extra));
      }
      ++points;
    }
    file.append(bytes.data(), bytes.size());
    bytes.clear();
  }
  const std::string header = pcd_header(points, columns);
  file.overwrite(0, header.data(), header.size());
  file.close();
}

void write_csv(const fs::path& temporary, const std::string& name, BeamSource& source) {
  OutputFile file(temporary, name);
  std::string text;
  bool first = true;
  for (BeamLog chunk; source.next(chunk);) {
    if (first) {
      text = kCsvColumns;
      for (const auto& [key, column] : chunk.extra) text += "," + key;
      text += "\n";
      first = false;
    }
    for (size_t i = 0; i < chunk.size(); ++i) {
      const Vec3 end = chunk.end_point(i);
      for (int c = 0; c < 3; ++c) put_number(text, end[c], ',');
      for (int c = 0; c < 3; ++c) put_number(text, chunk.origin[i][c], ',');
      text += chunk.is_hit(i) ? "1," : "0,";
      put_number(text, chunk.time_s[i], ',');
      put_number(text, chunk.intensity[i], ',');
      put_number(text, chunk.ring[i], ',');
      put_number(text, chunk.scan[i], ',');
      put_number(text, chunk.packet[i], ',');
      put_number(text, unsigned(chunk.flags[i]), ',');
      for (const auto& [key, column] : chunk.extra) {
        std::visit([&](const auto& c) { put_number(text, +c[i], ','); }, column);
      }
      text.back() = '\n';
    }
    file.append(text.data(), text.size());
    text.clear();
  }
  file.close();
}

// Writes the files of the scans. Scans may come one after the other or interleaved; beams are
// appended to their scan's file as they come.
class KittiFolder {
 public:
  KittiFolder(const fs::path& folder, const LogInfo& info) : folder_(folder) {
    make_temporary_folders(folder / "velodyne");
    std::string poses, times;
    for (const ScanInfo& scan : info.scans) {
      scans_[scan.scan] = {scan.world_from_sensor.inverse(), {}, 0};
      const Mat3 r = scan.world_from_sensor.rotation.toRotationMatrix();
      const Vec3& t = scan.world_from_sensor.translation;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) put_number(poses, r(i, j), ' ');
        put_number(poses, t[i], i < 2 ? ' ' : '\n');
      }
      put_number(times, scan.time_s, '\n');
    }
    size_t number = 0;
    for (auto& [scan, entry] : scans_) entry.number = number++;
    write_file(folder / "poses_velo.txt", poses);
    write_file(folder / "times.txt", times);
  }

  void write(const BeamLog& chunk) {
    std::set<Entry*> touched;
    for (size_t i = 0; i < chunk.size(); ++i) {
      const auto scan = scans_.find(chunk.scan[i]);
      require(scan != scans_.end(), "export: a beam's scan has no pose");
      if (!chunk.is_hit(i)) continue;
      Entry& entry = scan->second;
      const Vec3f p = (entry.sensor_from_world * chunk.end_point(i)).cast<float>();
      for (int c = 0; c < 3; ++c) put(entry.bytes, p[c]);
      put(entry.bytes, chunk.intensity[i]);
      touched.insert(&entry);
    }
    for (Entry* entry : touched) append(*entry);
  }

  /// Creates the files of scans without a hit, too; they are empty.
  void close() {
    for (auto& [scan, entry] : scans_) append(entry);
  }

 private:
  struct Entry {
    Pose sensor_from_world;
    std::string bytes;
    size_t number = 0;  ///< Number of the file, which is also the row in the files of poses and
                        ///< times.
  };
  void append(Entry& entry) const {
    char name[32];
    std::snprintf(name, sizeof name, "%06zu.bin", entry.number);
    const fs::path path = folder_ / "velodyne" / name;
    std::ofstream out(path, std::ios::binary | std::ios::app);
    out.write(entry.bytes.data(), std::streamsize(entry.bytes.size()));
    if (!out.flush()) throw IoError(path.string() + ": cannot write");
    entry.bytes = std::string();  // Frees the memory, since there may be many scans.
  }

  fs::path folder_;
  std::map<uint32_t, Entry> scans_;
};

void write_kitti(const fs::path& temporary, BeamSource& source) {
  KittiFolder folder(temporary, source.info());
  for (BeamLog chunk; source.next(chunk);) folder.write(chunk);
  folder.close();
}

}  // namespace

namespace {

/// Throws `IoError` where a log of so many beams does not fit on the disk.
void check_room(const fs::path& path, size_t beams) {
  constexpr uint64_t kRow = 51, kCompact = 6;  // bytes of a beam, at least
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(folder, error);
  const uint64_t needed = beams * (path.extension() == ".ublog" ? kCompact : kRow);
  if (error || needed <= space.available || !fs::is_directory(folder, error)) return;
  throw IoError(path.string() + ": " + std::to_string(beams) + " beams need " +
                std::to_string(needed >> 20) + " MiB and more, and " +
                std::to_string(space.available >> 20) + " MiB are free: cannot write");
}

}  // namespace

void export_log(const fs::path& path, BeamSource& source, const std::string& format,
                const std::string& provenance) {
  const std::string ext = path.extension().string();
  const std::string kind = !format.empty() ? format : ext.empty() ? "kitti" : ext.substr(1);
  source.rewind();
  if (kind == "ply" || kind == "ublog") {
    if (!fs::exists(path) || fs::is_regular_file(path)) check_room(path, source.size());
    LogWriter writer(path, source.info(), provenance);
    for (BeamLog chunk; source.next(chunk);) writer.write(chunk);
    return writer.close();
  }
  if (kind != "pcd" && kind != "csv" && kind != "kitti") {
    throw std::invalid_argument(
        path.string() +
        ": no such format; name it .ply, .ublog, .pcd, .csv, or a folder. The "
        "command of the Python package also writes .las, .laz, .npz, "
        ".mcap, .db3 and .bag: pip install 'underbrush[formats]'");
  }
  if (kind == "kitti") {
    // Only a folder that an earlier export wrote may be replaced, never a user's data set.
    if (fs::exists(path) && !fs::exists(path / kKittiMark) && !fs::is_empty(path)) {
      throw IoError(path.string() +
                    ": cannot write: exists and is not ours; remove it or name another");
    }
    return write_atomically(
        path,
        [&](const fs::path& temporary) {
          write_kitti(temporary, source);
          write_file(temporary / kKittiMark, (provenance.empty() ? "{}" : provenance) + "\n");
        },
        OutputKind::kFolder);
  }
  write_atomically(path, [&](const fs::path& temporary) {
    if (kind == "pcd") write_pcd(temporary, path.string(), source);
    if (kind == "csv") write_csv(temporary, path.string(), source);
  });
}

void export_log(const fs::path& path, const BeamLog& log, const std::string& format,
                const std::string& provenance) {
  MemorySource source(log);
  export_log(path, source, format, provenance);
}

}  // namespace underbrush::io
