// The readers of logs, points, poses, meshes and maps.
#include "fuzz/readers/reader.hpp"
#include "underbrush/compact/chunk.hpp"
#include "underbrush/compact/cursor.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/geotiff.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/mesh_readers.hpp"
#include "underbrush/io/ply.hpp"
#include "underbrush/io/pose_columns.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/scan_folder.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::fuzz {
namespace {

// Reads a log to its end, as `import` does.
void read_input(const Path& path, const io::InputOptions& options = {}) {
  const io::Input input = io::open_input(path, options);
  if (input.beams) {
    for (BeamLog chunk; input.beams->next(chunk);) chunk.check();
  }
  if (input.scans) {
    for (size_t k = 0; k < input.scans->size(); ++k) input.scans->read(k);
  }
}

void read_log(const Path& path) {
  io::LogReader reader(path, 1000);
  for (BeamLog chunk; reader.next(chunk);) chunk.check();
  io::BeamReader beams(path, 100);
  for (BeamLog chunk; beams.next(chunk);) chunk.check();
  if (reader.size() > 0) reader.rows(reader.size() / 2, 1);
}

// Log files whose chunks are given by themselves, since a checksum guards them in a file.
constexpr const char* kChunkLogs[] = {"log.ply", "echoes.ply"};

template <size_t K>
void read_chunk(std::string_view bytes) {
  static const std::string kName = "a chunk";
  static const BeamLog kLog = io::read_log(kChunkLogs[K]);
  BeamLog log = kLog;  // For its extra columns.
  compact::Cursor in(bytes, kName, kName);
  compact::Scratch scratch;
  compact::decode(in, log.size(), scratch, log, 0);
}

void read_labels(const Path& path) {
  io::InputOptions options;
  options.labels = path;
  read_input("points-binary.pcd", options);
}

void read_words(std::string_view bytes) {
  const std::string text(bytes);
  io::time_of_date(text);
  io::pose_columns_of(text);
  if (text.find('\0') == text.npos) io::scan_file(text);
  try {
    io::frames_from_text(text);
  } catch (const std::invalid_argument&) {
  }
}

void read_mtl(const Path& path) {
  std::map<std::string, size_t> left_out;
  io::read_mtl(path, left_out);
}

const Reader kReaders[] = {
    {"log", "log.ply echoes.ply labelled.ply cloud.ply", read_log},
    {"compact-log", "log.ublog echoes.ublog", read_log},
    {"chunk", "0.chunk", read_chunk<0>},
    {"chunk-echoes", "1.chunk", read_chunk<1>},
    {"ply", "points-ascii.ply points-little.ply points-big.ply tree.ply model/ellipsoids.ply",
     [](const Path& path) { io::read_ply(path); }},
    {"points-ply", "points-little.ply points-ascii.ply points-big.ply",
     [](const Path& path) { read_input(path); }},
    {"pcd", "points-binary.pcd points-ascii.pcd points-compressed.pcd",
     [](const Path& path) { read_input(path); }},
    {"numpy", "points.npy", [](const Path& path) { read_input(path); }},
    {"npz", "points.npz", [](const Path& path) { read_input(path); }},
    {"csv", "points.csv", [](const Path& path) { read_input(path); }},
    {"csv-beams", "log.csv", [](const Path& path) { read_input(path); }},
    {"bin", "000000.bin", [](const Path& path) { read_input(path); }},
    {"labels", "points.label", read_labels},
    {"gzip", "points.csv.gz", [](const Path& path) { io::Unpacked unpacked(path); }},
    {"scan", "folder/000001.pcd", [](const Path&) { read_input("folder"); }},
    {"scan-poses", "drive/poses_velo.txt poses.txt timed.txt",
     [](const Path&) { read_input("drive"); }},
    {"scan-times", "drive/times.txt", [](const Path&) { read_input("drive"); }},
    {"calibration", "odometry/calib.txt", [](const Path&) { read_input("odometry"); }},
    {"oxts", "raw/oxts/data/0000000001.txt", [](const Path&) { read_input("raw"); }},
    {"dates", "raw/velodyne_points/timestamps.txt", [](const Path&) { read_input("raw"); }},
    {"oxts-calibration", "raw/calib_imu_to_velo.txt", [](const Path&) { read_input("raw"); }},
    {"poses", "poses.txt timed.txt kitti.txt drive/poses_velo.txt",
     [](const Path& path) { io::read_poses(path); }},
    {"trajectory", "path.txt poses.txt", [](const Path& path) { io::read_trajectory(path); }},
    {"json", "state.json site.json objects.json",
     [](const Path& path) { io::JsonFile(path).root().dump(); }},
    {"obj", "tree.obj world.obj", [](const Path& path) { io::read_mesh_scene(path); }},
    {"mtl", "world.mtl", read_mtl},
    {"spectrum", "paint.txt", [](const Path& path) { io::read_spectrum(path); }},
    {"stl", "rock.stl text.stl", [](const Path& path) { io::read_mesh_scene(path); }},
    {"mesh-ply", "tree.ply binary.ply", [](const Path& path) { io::read_mesh_scene(path); }},
    {"gltf", "tree.gltf inline.gltf", [](const Path& path) { io::read_mesh_scene(path); }},
    {"glb", "tree.glb", [](const Path& path) { io::read_mesh_scene(path); }},
    {"geotiff", "geotiff/*",
     [](const Path& path) {
       std::map<std::string, size_t> left_out;
       io::read_geotiff(path, left_out);
     }},
    {"words", "times.txt raw/oxts/timestamps.txt table.csv", read_words},
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

void make_seeds() {
  for (size_t k = 0; k < std::size(kChunkLogs); ++k) {
    compact::Scratch scratch;
    const BeamLog log = io::read_log(kChunkLogs[k]);
    const std::vector<ScanInfo> scans = io::LogReader(kChunkLogs[k]).info().scans;
    write_file(std::to_string(k) + ".chunk", compact::encoded(log, scans, 0, log.size(), scratch));
  }
}

}  // namespace underbrush::fuzz
