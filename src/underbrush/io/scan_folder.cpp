#include "underbrush/io/scan_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/gzip.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/pose_gaps.hpp"
#include "underbrush/io/scan_times.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr double kFramePeriod = 0.1;  // s; assumed where no times are known.

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
constexpr const char* kInGaps = "scans in gaps of the poses";

class ScanFolder : public ScanSource {
 public:
  ScanFolder(std::vector<ScanFile> files, std::vector<ScanInfo> infos, Trajectory trajectory,
             const ScanPlacing& placing, double period_s, size_t in_gaps)
      : files_(std::move(files)),
        infos_(std::move(infos)),
        trajectory_(std::move(trajectory)),
        columns_(placing.columns),
        points_in_world_(placing.points_in_world),
        unit_m_(placing.unit_m),
        times_(period_s, placing.count) {
    if (in_gaps > 0) skipped_[kInGaps] = in_gaps;
  }

  size_t size() const override { return files_.size(); }
  const Trajectory& trajectory() const override { return trajectory_; }
  const std::map<std::string, size_t>& skipped() const override { return skipped_; }
  PointScan read(size_t k) override {
    require(k < files_.size(), "scan: no such scan");
    const ScanFile& file = files_[k];
    const bool empty = files_.size() > 1 && fs::file_size(file.path) == 0;
    Table table = empty ? Table() : read_scan_table(file.path);
    if (table.size() == 0 && files_.size() > 1) {
      ++skipped_[kEmptyScans];
      PointScan none;
      none.info = infos_[k];
      return none;
    }
    if (notes_.empty()) notes_ = table.notes;
    if (points_in_world_) step_m_ = std::max(step_m_, table.step() * unit_m_);
    keep_bin_columns(file.path, table);
    PointScan scan = scan_from_table(file.path.string(), std::move(table),
                                     {infos_[k], points_in_world_, unit_m_, &times_}, skipped_);
    if (!file.labels.empty()) add_labels(file.labels, scan);
    check_columns(file.path, scan);
    return scan;
  }
  std::vector<std::string> warnings() const {
    constexpr double kCoarse = 0.01;  // m
    if (step_m_ < kCoarse) return {};
    char text[200];
    std::snprintf(text, sizeof text,
                  "the coordinates are 32-bit floats, which are rounded to steps of %.3g m so far "
                  "from zero: write them as doubles, or relative to a place nearby",
                  step_m_);
    return {text};
  }
  std::vector<std::string> notes() const {
    std::vector<std::string> all = notes_;
    if (!times_.note().empty()) all.push_back(times_.note());
    return all;
  }

 private:
  Table read_scan_table(const fs::path& path) const {
    if (!is_gzip(path)) return read_table(path, columns_);
    const Unpacked unpacked(path);
    try {
      return read_table(unpacked.path(), columns_);
    } catch (const FormatError& e) {
      throw FormatError(path.string(), e.place(), e.reason());
    }
  }

  // The first .bin file determines the columns of all.
  void keep_bin_columns(const fs::path& path, const Table& table) {
    if (!columns_.empty() || (is_gzip(path) ? path.stem() : path).extension() != ".bin") return;
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
  double step_m_ = 0;  // Step of the coordinates in the world, where it is largest.
  PointTimes times_;
  std::vector<std::string> notes_;
  std::map<std::string, size_t> skipped_;
};

/// Whether scans take the times of as many poses in their order: there are no others, or those in
/// the names of the scans are of another clock.
bool poses_have_the_scans_times(const std::vector<ScanFile>& files, const ScanPlacing& placing) {
  const std::vector<double>& times = placing.poses.time_s;
  if (!placing.times.empty() || times.empty() || times.size() != files.size()) return false;
  const auto [low, high] = std::minmax_element(times.begin(), times.end());
  const double from = 2 * *low - *high, to = 2 * *high - *low;
  return std::ranges::none_of(
      files, [&](const ScanFile& f) { return f.time_s && *f.time_s >= from && *f.time_s <= to; });
}

/// Finds the time and pose of every scan.
class Placer {
 public:
  Placer(const std::vector<ScanFile>& files, const ScanPlacing& placing, Input& input)
      : files_(files), placing_(placing), input_(input) {
    poses_ = placing.poses;
    PoseList& poses = poses_;
    if (poses.numbered && !placing.times.empty()) times_of_frames(poses);
    timed_ = !poses.time_s.empty();
    by_order_ = poses_have_the_scans_times(files, placing);
    if (by_order_) {
      input.notes.emplace_back(files[0].time_s
                                   ? "scans take the poses' times in order: those in their names "
                                     "lie outside of the poses'"
                                   : "scans take the poses' times in order: none of their own");
    }
    if (!timed_ && placing.times.empty()) {
      input.notes.push_back("no times: frames are taken to be 0.1 s apart");
    }
    const size_t last = files.empty() ? 0 : std::ranges::max(files, {}, &ScanFile::frame).frame;
    const size_t poses_by_number = timed_ ? 0 : poses.pose.size();
    for (const auto& [rows, what] :
         {std::pair(poses_by_number, "poses"), {placing.times.size(), "times"}}) {
      if (rows <= last + 1) continue;
      input.notes.push_back("there are " + std::to_string(rows) + " " + what +
                            " for the scans 0 to " + std::to_string(last) +
                            ": the first is that of scan 0");
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
    if (timed_ && !by_order_) gaps = split_at_gaps(stamped, placing.period_s);
    trajectory = Trajectory(stamped);
  }

  Trajectory trajectory;
  std::vector<PoseGap> gaps;  ///< Scans in them are left out.

  /// The usual time between scans, s; without times the one that is given.
  double period() const {
    std::vector<double> times = by_order_ ? poses_.time_s : placing_.times;
    if (times.empty() && timed_) {
      for (const ScanFile& file : files_) times.push_back(file.time_s.value_or(NAN));
    }
    const double usual = usual_step(times);
    return usual > 0 ? usual : placing_.period_s;
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
                        "no time to find its pose with (" + std::to_string(files_.size()) +
                            " scans, " + std::to_string(poses_.pose.size()) +
                            " poses): give one with --times");
    }
    time = on_clock(time);
    return {file.frame, time, pose_at(time, name)};
  }

 private:
  Pose pose_at(double time, const std::string& scan) const {
    const auto pose = trajectory.at(time);
    if (pose) return *pose;
    const std::vector<StampedPose>& poses = trajectory.poses();
    std::string reason = "no pose for scan " + scan;
    if (!poses.empty()) reason += times_of_poses(time, poses.front().time_s, poses.back().time_s);
    throw FormatError(placing_.poses_name, "time " + std::to_string(time), reason);
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

}  // namespace

void place_scans(std::vector<ScanFile> files, ScanPlacing placing, Input& input) {
  count_by_names(files, placing, input.notes);
  use_seconds(placing, poses_have_the_scans_times(files, placing), input.notes);
  const Placer placer(files, placing, input);
  std::vector<ScanFile> selected;
  std::vector<size_t> lost(placer.gaps.size());
  for (size_t k = 0; k < files.size(); ++k) {
    if (!placing.frames.has(files[k].frame)) continue;
    const ScanInfo info = placer.place(k);
    const auto gap =
        std::ranges::find_if(placer.gaps, [&](const auto& g) { return g.has(info.time_s); });
    if (gap != placer.gaps.end()) {
      ++lost[size_t(gap - placer.gaps.begin())];
      continue;
    }
    input.scan_infos.push_back(info);
    selected.push_back(files[k]);
  }
  size_t in_gaps = 0;
  for (size_t g = 0; g < lost.size(); ++g) {
    if (lost[g] == 0) continue;
    in_gaps += lost[g];
    const PoseGap& gap = placer.gaps[g];
    char text[200];
    std::snprintf(
        text, sizeof text,
        "the poses have a gap of %.1f s from %.2f s on, in which the sensor moves by %.1f "
        "m: %zu scans in it are left out",
        gap.to_s - gap.from_s, gap.from_s, gap.moved_m, lost[g]);
    if (selected.empty()) throw FormatError(placing.poses_name, "", text);
    input.notes.emplace_back(text);
  }
  require(!selected.empty(), "no scan is within the selected frames");
  input.notes.insert(input.notes.end(), placing.poses.notes.begin(), placing.poses.notes.end());
  auto source = std::make_unique<ScanFolder>(std::move(selected), input.scan_infos,
                                             placer.trajectory, placing, placer.period(), in_gaps);
  input.skipped = [raw = source.get()] { return raw->skipped(); };
  input.read_notes = [raw = source.get()] { return raw->notes(); };
  input.read_warnings = [raw = source.get()] { return raw->warnings(); };
  input.scans = std::move(source);
}

}  // namespace underbrush::io
