#include "underbrush/io/scan_folder.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr double kFramePeriod = 0.1;  // s; assumed where no times are known.

bool all_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::optional<double> time_in_name(const std::string& stem) {
  if (stem.size() == 19 && all_digits(stem)) return std::stod(stem) * 1e-9;
  const size_t mark = stem.find_first_of("_.");
  if (mark == std::string::npos || mark < 9) return std::nullopt;
  const std::string seconds = stem.substr(0, mark), fraction = stem.substr(mark + 1);
  if (!all_digits(seconds) || !all_digits(fraction)) return std::nullopt;
  // Digits behind "_" are nanoseconds; digits behind "." are a decimal fraction.
  if (stem[mark] == '_') return std::stod(seconds) + std::stod(fraction) * 1e-9;
  return std::stod(stem);
}

void add_labels(const fs::path& path, PointScan& scan) {
  const std::string bytes = read_file(path);
  if (bytes.size() != 4 * scan.size()) {
    throw FormatError(path.string(), "",
                      std::to_string(bytes.size() / 4) + " labels for " +
                          std::to_string(scan.size()) + " points");
  }
  std::vector<uint16_t> label(scan.size()), instance(scan.size());
  for (size_t i = 0; i < scan.size(); ++i) {
    label[i] = load<uint16_t>(bytes.data() + 4 * i);
    instance[i] = load<uint16_t>(bytes.data() + 4 * i + 2);
  }
  scan.extra["class"] = std::move(label);
  scan.extra["instance"] = std::move(instance);
}

constexpr const char* kEmptyScans = "empty scans: files without a point";

class ScanFolder : public ScanSource {
 public:
  ScanFolder(std::vector<ScanFile> files, std::vector<ScanInfo> infos, Trajectory trajectory,
             const ScanPlacing& placing, double period_s)
      : files_(std::move(files)),
        infos_(std::move(infos)),
        trajectory_(std::move(trajectory)),
        columns_(placing.columns),
        points_in_world_(placing.points_in_world),
        unit_m_(placing.unit_m),
        times_(period_s) {}

  size_t size() const override { return files_.size(); }
  const Trajectory& trajectory() const override { return trajectory_; }
  const std::map<std::string, size_t>& skipped() const override { return skipped_; }
  PointScan read(size_t k) override {
    require(k < files_.size(), "scan: no such scan");
    const ScanFile& file = files_[k];
    Table table = read_table(file.path, columns_);
    if (table.size() == 0 && files_.size() > 1) {
      ++skipped_[kEmptyScans];
      PointScan none;
      none.info = infos_[k];
      return none;
    }
    if (notes_.empty()) notes_ = table.notes;
    keep_bin_columns(file.path, table);
    PointScan scan = scan_from_table(file.path.string(), std::move(table),
                                     {infos_[k], points_in_world_, unit_m_, &times_}, skipped_);
    if (!file.labels.empty()) add_labels(file.labels, scan);
    check_columns(file.path, scan);
    return scan;
  }
  std::vector<std::string> notes() const {
    std::vector<std::string> all = notes_;
    if (!times_.note().empty()) all.push_back(times_.note());
    return all;
  }

 private:
  // The first .bin file tells the columns of all.
  void keep_bin_columns(const fs::path& path, const Table& table) {
    if (!columns_.empty() || path.extension() != ".bin") return;
    for (const auto& [name, column] : table.columns) columns_.push_back(name);
  }

  // All scans of a log must carry the same columns.
  void check_columns(const fs::path& path, const PointScan& scan) {
    std::map<std::string, ValueType> columns;
    for (const auto& [name, column] : scan.extra) columns[name] = type_of(column);
    if (!first_columns_) first_columns_ = columns;
    if (columns == *first_columns_) return;
    throw FormatError(path.string(), "header", "other columns than the scans before it");
  }

  std::vector<ScanFile> files_;
  /// Columns of the first scan that was read.
  std::optional<std::map<std::string, ValueType>> first_columns_;
  std::vector<ScanInfo> infos_;
  Trajectory trajectory_;
  std::vector<std::string> columns_;  // Names for files that have none.
  bool points_in_world_;
  double unit_m_;
  PointTimes times_;
  std::vector<std::string> notes_;
  std::map<std::string, size_t> skipped_;
};

/// Finds the time and pose of every scan.
class Placer {
 public:
  Placer(const std::vector<ScanFile>& files, const ScanPlacing& placing, Input& input)
      : files_(files), placing_(placing), input_(input) {
    poses_ = placing.poses;
    PoseList& poses = poses_;
    if (poses.numbered && !placing.times.empty()) times_of_frames(poses);
    timed_ = !poses.time_s.empty();
    by_order_ = timed_ && placing.times.empty() && poses.pose.size() == files.size() &&
                std::none_of(files.begin(), files.end(), [](const auto& f) { return f.time_s; });
    if (by_order_) input.notes.push_back("scans take the poses' times in order: none of their own");
    if (!timed_ && placing.times.empty()) {
      input.notes.push_back("no times: frames are taken to be 0.1 s apart");
    }
    std::vector<StampedPose> stamped;
    for (size_t i = 0; i < poses.pose.size(); ++i) {
      if (!timed_ && !placing.times.empty() && i >= placing.times.size()) break;
      stamped.push_back({timed_ ? poses.time_s[i] : time_of_frame(i), poses.pose[i]});
    }
    const auto earlier = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
    if (!std::is_sorted(stamped.begin(), stamped.end(), earlier)) {
      input.notes.push_back("the poses were not in order of time: sorted");
      std::stable_sort(stamped.begin(), stamped.end(), earlier);
    }
    if (placing.fit_clock) fit_clock(stamped);
    trajectory = Trajectory(stamped);
  }

  Trajectory trajectory;

  /// The usual time between scans, s; without times the one that is given.
  double period() const {
    std::vector<double> times = by_order_ ? poses_.time_s : placing_.times;
    if (times.empty() && timed_) {
      for (const ScanFile& file : files_) times.push_back(file.time_s.value_or(NAN));
    }
    std::vector<double> steps;
    for (size_t i = 1; i < times.size(); ++i) {
      if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
    }
    if (steps.empty()) return placing_.period_s;
    std::nth_element(steps.begin(), steps.begin() + long(steps.size() / 2), steps.end());
    return steps[steps.size() / 2];
  }

  ScanInfo place(size_t k) const {
    const ScanFile& file = files_[k];
    const std::string name = file.path.filename().string();
    if (!timed_) {
      if (file.frame >= poses_.pose.size()) {
        throw FormatError(placing_.poses_name, "row " + std::to_string(file.frame + 1),
                          "no pose for scan " + name);
      }
      const double time = on_clock(time_of_frame(file.frame));
      if (!input_.clock || input_.clock->poses_follow) {
        return {file.frame, time, poses_.pose[file.frame]};
      }
      return {file.frame, time, pose_at(time, name)};
    }
    double time = 0;
    if (by_order_) {
      time = poses_.time_s[k];
    } else if (!placing_.times.empty()) {
      time = time_of_frame(file.frame);
    } else if (file.time_s) {
      time = *file.time_s;
    } else {
      throw FormatError(file.path.string(), "",
                        "no time to find its pose with: give one with --times");
    }
    time = on_clock(time);
    return {file.frame, time, pose_at(time, name)};
  }

 private:
  Pose pose_at(double time, const std::string& scan) const {
    const auto pose = trajectory.at(time);
    if (pose) return *pose;
    throw FormatError(placing_.poses_name, "time " + std::to_string(time),
                      "no pose for scan " + scan);
  }

  // Poses whose first column has the numbers of the scans get the times of these.
  void times_of_frames(PoseList& poses) {
    const std::vector<double>& times = placing_.times;
    const auto [low, high] = std::minmax_element(poses.time_s.begin(), poses.time_s.end());
    if (*low <= times.back() && *high >= times.front()) return;  // They are times.
    for (double& t : poses.time_s) t = time_of_frame(size_t(t));
    input_.notes.push_back("the first column of the poses is taken for the numbers of the scans");
  }

  // Fits a clock to the times of the scans, and gives its times to the poses if they follow it.
  void fit_clock(std::vector<StampedPose>& poses) {
    given_ = by_order_ ? poses_.time_s : placing_.times;
    if (given_.empty()) {
      for (const ScanFile& file : files_) given_.push_back(file.time_s.value_or(0));
    }
    const bool ascend =
        std::adjacent_find(given_.begin(), given_.end(), std::greater_equal<>()) == given_.end();
    if (ascend) input_.clock = fit_scan_clock(given_);
    if (!input_.clock) return;
    std::vector<double> fitted;
    for (const StampedPose& pose : poses) {
      if (!std::binary_search(given_.begin(), given_.end(), pose.time_s)) return;
      fitted.push_back(on_clock(pose.time_s));
    }
    input_.clock->poses_follow = poses_follow_clock(poses, fitted);
    if (!input_.clock->poses_follow) return;
    for (size_t i = 0; i < poses.size(); ++i) poses[i].time_s = fitted[i];
  }

  // The clock's time of a scan; without a clock the given one.
  double on_clock(double given) const {
    if (!input_.clock) return given;
    const auto at = std::lower_bound(given_.begin(), given_.end(), given) - given_.begin();
    return input_.clock->time_s[size_t(at)];
  }

  double time_of_frame(size_t frame) const {
    if (placing_.times.empty()) return double(frame) * kFramePeriod;
    if (frame < placing_.times.size()) return placing_.times[frame];
    throw FormatError(placing_.times_name, "row " + std::to_string(frame + 1),
                      "no time for scan " + std::to_string(frame));
  }

  const std::vector<ScanFile>& files_;
  const ScanPlacing& placing_;
  Input& input_;
  PoseList poses_;
  std::vector<double> given_;  // the times of all scans, ascending, if there is a clock
  bool timed_ = false, by_order_ = false;
};

bool is_frame_number(const std::string& stem) {
  return all_digits(stem) && (stem.size() <= 9 || (stem.size() == 10 && stem[0] == '0'));
}

}  // namespace

ScanFile scan_file(const fs::path& path) {
  const std::string stem = path.stem().string();
  if (is_frame_number(stem)) return {path, {}, uint32_t(std::stoul(stem)), {}};
  return {path, {}, 0, time_in_name(stem)};
}

std::vector<ScanFile> list_scans(const fs::path& folder) {
  std::vector<ScanFile> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with('.')) continue;
    const std::string ext = lower(entry.path().extension().string());
    if (ext == ".ply" || ext == ".pcd" || ext == ".bin" || ext == ".npy" || ext == ".npz") {
      files.push_back(scan_file(entry.path()));
    }
  }
  if (error) throw FormatError(folder.string(), "", error.message());
  if (files.empty()) {
    const bool recording = fs::exists(folder / "metadata.yaml", error);
    throw FormatError(folder.string(), "", recording ? kRecording : "no scans in it");
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.path < b.path; });
  const bool numbered = std::all_of(files.begin(), files.end(), [](const ScanFile& file) {
    return is_frame_number(file.path.stem().string());
  });
  if (!numbered) {
    for (size_t i = 0; i < files.size(); ++i) files[i].frame = uint32_t(i);
  }
  std::stable_sort(files.begin(), files.end(),
                   [](const auto& a, const auto& b) { return a.frame < b.frame; });
  for (size_t i = 1; i < files.size(); ++i) {
    if (files[i].frame != files[i - 1].frame) continue;
    throw FormatError(files[i].path.string(), "", "the number of another scan");
  }
  return files;
}

void place_scans(std::vector<ScanFile> files, const ScanPlacing& placing, Input& input) {
  const Placer placer(files, placing, input);
  std::vector<ScanFile> selected;
  for (size_t k = 0; k < files.size(); ++k) {
    if (!placing.frames.has(files[k].frame)) continue;
    input.scan_infos.push_back(placer.place(k));
    selected.push_back(files[k]);
  }
  require(!selected.empty(), "no scan is within the selected frames");
  input.notes.insert(input.notes.end(), placing.poses.notes.begin(), placing.poses.notes.end());
  auto source = std::make_unique<ScanFolder>(std::move(selected), input.scan_infos,
                                             placer.trajectory, placing, placer.period());
  input.skipped = [raw = source.get()] { return raw->skipped(); };
  input.read_notes = [raw = source.get()] { return raw->notes(); };
  input.scans = std::move(source);
}

}  // namespace underbrush::io
