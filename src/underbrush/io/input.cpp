#include "underbrush/io/input.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/io/csv_beams.hpp"
#include "underbrush/io/log_path.hpp"
#include "underbrush/io/log_rows.hpp"
#include "underbrush/io/oxts.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/scan_folder.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSemanticKitti = "semantickitti";

bool is_ray_cloud(const fs::path& path) {
  const InputFile file(path);
  const PlyHeader header = read_ply_header(file);
  if (header.elements.empty()) return false;
  const auto has = [&](const char* name) {
    const auto& all = header.elements[0].properties;
    return std::any_of(all.begin(), all.end(), [&](const auto& p) { return p.name == name; });
  };
  return has("time") && (has("nx") || has("rayx"));
}

std::string format_of(const fs::path& path) {
  if (fs::is_directory(path)) {
    if (fs::is_directory(path / "velodyne_points" / "data")) return "kitti-raw";
    if (!fs::is_directory(path / "velodyne")) return "folder";
    return read_calibration(path / "calib.txt", "Tr") ? "kitti-odometry" : "kitti";
  }
  const std::string extension = lower(path.extension().string());
  if (is_compact(path)) return "compact";
  if (extension == ".ply" && is_ray_cloud(path)) return "ray-cloud";
  if (extension == ".csv" || extension == ".txt" || extension == ".xyz") return "csv";
  return "scan";
}

/// Opens a log, trying one format after the other.
class Opener {
 public:
  Opener(const fs::path& path, const InputOptions& options) : path_(path), options_(options) {
    placing_.frames = options.frames;
    placing_.points_in_world = options.points_in_world;
    placing_.fit_clock = options.fit_clock;
    placing_.columns = options.columns;
    placing_.unit_m = options.unit_m;
    placing_.period_s = options.scan_period_s;
    placing_.count = options.count;
    if (!options.poses.empty()) set_poses(read_poses(options.poses), options.poses);
    if (!options.times.empty()) set_times(read_times(options.times), options.times);
  }

  Input open(const std::string& format) {
    input_.format = format;
    if (format == "ray-cloud" || format == "compact") {
      open_log();
    } else if (format == "csv") {
      open_csv();
    } else if (format == "scan") {
      open_scan(read_table(path_, options_.columns));
    } else if (format == "kitti") {
      open_kitti();
    } else if (format == "kitti-odometry") {
      open_odometry();
    } else if (format == "kitti-raw") {
      open_raw();
    } else {
      open_folder();
    }
    return std::move(input_);
  }

 private:
  void set_poses(PoseList poses, const fs::path& name) {
    placing_.poses = std::move(poses);
    placing_.poses_name = name.string();
  }
  void set_times(std::vector<double> times, const fs::path& name) {
    if (const std::string unit = use_dates(times); !unit.empty()) {
      input_.notes.push_back("the times of the scans are taken to be " + unit);
    }
    placing_.times = std::move(times);
    placing_.times_name = name.string();
  }
  bool has_poses() const { return !placing_.poses.pose.empty(); }
  void need_poses() const {
    if (!has_poses())
      throw FormatError(path_.string(), "", "no poses: give them with --poses FILE");
  }
  void default_times() {
    const fs::path file = path_ / "times.txt";
    if (placing_.times.empty() && fs::exists(file)) set_times(read_times(file), file);
  }

  void open_log() {
    auto reader = std::make_unique<LogReader>(path_);
    input_.provenance = reader->provenance();
    input_.skipped = [raw = reader.get()] { return raw->skipped(); };
    input_.is_log = true;
    input_.beams = std::move(reader);
  }

  void open_csv() {
    Table table = read_csv(path_, options_.columns);
    if (!has_origins(table)) return open_scan(std::move(table));
    std::map<std::string, size_t> skipped;
    input_.beams =
        std::make_unique<LogInMemory>(beams_from_table(path_.string(), std::move(table), skipped));
    input_.skipped = [skipped] { return skipped; };
  }

  void open_scan(Table table) {
    ScanFile file = scan_file(path_);
    file.labels = options_.labels;
    if (!file.labels.empty()) input_.classes = kSemanticKitti;
    Pose pose;
    if (has_poses()) {
      if (placing_.poses.pose.size() == 1) file.frame = 0;
      return place_scans({file}, placing_, input_);
    }
    file.frame = 0;
    if (table.viewpoint) {
      pose = *table.viewpoint;
      input_.notes.push_back("no poses given: the file's own viewpoint is the sensor's pose");
    } else {
      input_.notes.push_back("no poses given: the sensor stands at the origin");
    }
    // The scanner stands still, and its time is the time that the file gives.
    std::map<std::string, size_t> ignored;
    const ScanContext context{{0, 0, pose}, options_.points_in_world, options_.unit_m};
    const PointScan scan = scan_from_table(path_.string(), std::move(table), context, ignored);
    double start = placing_.times.empty() ? 0 : placing_.times[0];
    double first = INFINITY;
    for (const double t : scan.time_s) {
      if (std::isfinite(t)) first = std::min(first, t);
    }
    if (std::isfinite(first) && first > 100) start = first;
    constexpr double kStanding = 3600, kLatest = 1e12;  // s
    if (std::abs(start) > kLatest) {
      throw FormatError(path_.string(), "", "its times are beyond 10^12 s");
    }
    PoseList standing;
    standing.pose = {pose, pose, pose};
    standing.time_s = {start - kStanding, start, start + kStanding};
    set_poses(std::move(standing), path_);
    file.time_s = start;
    placing_.times.clear();
    place_scans({file}, placing_, input_);
  }

  void open_kitti() {
    default_times();
    for (const char* name : {"poses_velo.txt", "poses.txt"}) {
      const fs::path file = path_ / name;
      if (has_poses() || !fs::exists(file)) continue;
      set_poses(read_poses(file), file);
      if (placing_.poses.time_s.empty() && std::string(name) == "poses.txt") check_calibration();
    }
    if (!has_poses() && fs::is_directory(path_ / "oxts" / "data")) use_oxts();
    need_poses();
    place_scans(list_scans(path_ / "velodyne", input_.notes), placing_, input_);
  }

  /// KITTI's own poses are those of the left camera, which only Tr leads to the lidar.
  void check_calibration() const {
    const fs::path calib = path_ / "calib.txt";
    if (!read_calibration(calib, "P0")) return;
    throw FormatError(calib.string(), "Tr",
                      "is missing, and poses.txt has the poses of the left camera: add the line "
                      "'Tr: …' of the lidar's archive (or of calib_velo_to_cam.txt), or give poses "
                      "of the lidar with --poses");
  }

  void open_odometry() {
    default_times();
    const fs::path calib = path_ / "calib.txt", poses = path_ / "poses.txt";
    const auto tr = read_calibration(calib, "Tr");
    if (!tr || tr->size() != 12) throw FormatError(calib.string(), "Tr", "expected 12 numbers");
    std::array<double, 12> rows{};
    std::copy(tr->begin(), tr->end(), rows.begin());
    const auto camera_from_velo = pose_from_rows(rows);
    if (!camera_from_velo) throw FormatError(calib.string(), "Tr", "not a rotation");
    if (has_poses()) {
      input_.notes.push_back(
          "the given poses are taken for those of the left camera, as Tr of "
          "calib.txt has it; --format kitti takes them for those of the lidar");
    } else if (fs::exists(poses)) {
      set_poses(read_poses(poses), poses);
    }
    need_poses();
    for (Pose& pose : placing_.poses.pose) {
      pose = camera_from_velo->inverse() * pose * *camera_from_velo;
    }
    std::vector<ScanFile> files = list_scans(path_ / "velodyne", input_.notes);
    if (fs::is_directory(path_ / "labels")) {
      input_.classes = kSemanticKitti;
      for (ScanFile& file : files) {
        file.labels = path_ / "labels" / (scan_stem(file.path) + ".label");
      }
    }
    input_.compensated = true;
    input_.notes.push_back("KITTI odometry: the scans are motion-compensated already");
    place_scans(std::move(files), placing_, input_);
  }

  void use_oxts() {
    OxtsPoses oxts = read_oxts(path_);
    if (!oxts.calibrated) {
      input_.notes.push_back("no calib_imu_to_velo.txt: the sensor is taken to be at the INS");
    }
    set_poses(std::move(oxts.poses), path_ / "oxts");
  }

  void open_raw() {
    const fs::path folder = path_ / "velodyne_points", stamps = folder / "timestamps.txt";
    if (placing_.times.empty() && fs::exists(stamps)) set_times(read_dates(stamps), stamps);
    if (!has_poses()) use_oxts();
    place_scans(list_scans(folder / "data", input_.notes), placing_, input_);
  }

  void open_folder() {
    refuse_world(path_);
    default_times();
    const fs::path file = path_ / "poses.txt";
    if (!has_poses() && fs::exists(file)) set_poses(read_poses(file), file);
    std::vector<ScanFile> files = list_scans(path_, input_.notes);
    need_poses();
    place_scans(std::move(files), placing_, input_);
  }

  const fs::path& path_;
  const InputOptions& options_;
  ScanPlacing placing_;
  Input input_;
};

}  // namespace

FrameRange frames_from_text(const std::string& text) {
  FrameRange range;
  uint32_t* const parts[] = {&range.first, &range.end, &range.step};
  size_t part = 0, at = 0;
  while (true) {
    const size_t end = std::min(text.find(':', at), text.size());
    if (end > at) {
      const auto [stop, error] = std::from_chars(&text[at], text.data() + end, *parts[part]);
      require(error == std::errc() && stop == text.data() + end,
              "frames: expected A:B or A:B:STEP");
    }
    if (end == text.size()) break;
    at = end + 1;
    require(++part < 3, "frames: expected A:B or A:B:STEP");
  }
  require(part > 0, "frames: expected A:B or A:B:STEP");
  require(range.step > 0 && range.first < range.end, "frames: no frame lies in that range");
  return range;
}

std::vector<std::string> input_formats() {
  return {"ray-cloud", "compact", "csv", "scan", "kitti", "kitti-odometry", "kitti-raw", "folder"};
}

namespace {

/// Opens what a file of gzip holds. Errors in it have the name of the packed file.
Input open_packed(const fs::path& path, const InputOptions& options) {
  const auto unpacked = std::make_shared<const Unpacked>(path);
  try {
    Input input = open_input(unpacked->path(), options);
    input.unpacked = unpacked;
    input.is_log = false;
    return input;
  } catch (const FormatError& e) {
    const bool is_inner = e.file() == unpacked->path().string();
    throw FormatError(is_inner ? path.string() : e.file(), e.place(), e.reason());
  }
}

}  // namespace

Input open_input(const fs::path& path, const InputOptions& options) try {
  if (!fs::exists(path)) throw FormatError(path.string(), "", "no such file or folder");
  const auto known = input_formats();
  require(options.format.empty() ||
              std::find(known.begin(), known.end(), options.format) != known.end(),
          "import: unknown format");
  if (is_gzip(path)) return open_packed(path, options);
  const std::string format = options.format.empty() ? format_of(path) : options.format;
  require(options.labels.empty() || format == "scan",
          "import: --labels is for a single scan without origins");
  return Opener(path, options).open(format);
} catch (const fs::filesystem_error& e) {
  throw FormatError(path.string(), "", e.code().message());
}

}  // namespace underbrush::io
