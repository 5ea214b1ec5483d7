#include "underbrush/perception/log_truth.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/object_list_file.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::perception {
namespace {

// The place with the same bearing and range, and the elevation raised by an angle.
Vec3 raised(const Vec3& p, double angle_rad) {
  const double flat = p.head<2>().norm(), range = p.norm();
  if (flat < 1e-9) return p;
  const double elevation = std::atan2(p.z(), flat) + angle_rad;
  const double scale = range * std::cos(elevation) / flat;
  return {p.x() * scale, p.y() * scale, range * std::sin(elevation)};
}

double yaw_of(const Pose& pose) {
  const Vec3 forward = pose.rotation * Vec3::UnitX();
  return std::atan2(forward.y(), forward.x());
}

// When a spinning sensor looks into a bearing, after the instant at which it faces forward.
class Sweep {
 public:
  Sweep(const LogInfo& log, const Trajectory& path) {
    if (!log.deskewed || log.sensor.empty() || path.poses().size() < 2) return;
    const sensor::Sensor s = sensor::sensor_of_log("the log", log);
    if (s.kind != sensor::Kind::kSpinning) return;
    const double span = path.poses().back().time_s - path.poses().front().time_s;
    revolution_s_ = s.turn() * span / double(path.poses().size() - 1);
  }
  double after_s(double bearing_rad) const { return bearing_rad / (2 * M_PI) * revolution_s_; }

 private:
  double revolution_s_ = 0;  ///< Negative for a sensor that turns clockwise.
};

}  // namespace

LogTruth::LogTruth(const std::filesystem::path& file, const LogInfo& log,
                   const LogTruthOptions& options)
    : is_labelled_(is_labelled_box_file(file)),
      sequence_(is_labelled_ ? std::vector<ObjectList>{} : read_object_lists(file)) {
  if (!is_labelled_) return;
  const std::vector<LabelledBox> boxes = read_labelled_boxes(file);
  place(boxes, log, options);
  if (boxes.empty() || !by_scan_.empty() || log.scans.empty()) return;
  const auto [first, last] = std::ranges::minmax(boxes, {}, &LabelledBox::frame);
  throw FormatError(file.string(), "frame",
                    "none of the boxes' frames, " + std::to_string(first.frame) + " to " +
                        std::to_string(last.frame) + ", is a scan of the log within its poses");
}

LogTruth::LogTruth(const std::vector<ObjectList>& lists) : sequence_(lists) {}

void LogTruth::place(const std::vector<LabelledBox>& boxes, const LogInfo& log,
                     const LogTruthOptions& options) {
  std::vector<StampedPose> poses;
  std::map<uint32_t, double> time_s;
  for (const ScanInfo& s : log.scans) {
    poses.push_back({s.time_s, s.world_from_sensor});
    time_s[s.scan] = s.time_s;
  }
  const Trajectory path(poses);
  const Sweep sweep(log, path);
  for (const LabelledBox& box : boxes) {
    const auto scan = time_s.find(box.frame);
    if (scan == time_s.end()) continue;
    TruthObject o = box.object;
    const Vec3& c = o.box.centre_m;
    const double seen_s = scan->second + sweep.after_s(std::atan2(c.y(), c.x()));
    const auto pose = path.at(seen_s);
    if (!pose) continue;
    o.box.centre_m = *pose * raised(c, options.elevation_offset_rad);
    o.box.yaw_rad = wrapped(o.box.yaw_rad + yaw_of(*pose));
    by_scan_[box.frame].push_back(o);
    seen_.push_back({box.frame, seen_s, o});
  }
}

void LogTruth::at(uint32_t scan, double time_s, double cycle_s, TruthFrame& frame) const {
  if (!is_labelled_) return sequence_.at(time_s, cycle_s / 2, frame);
  frame.time_s = time_s;
  frame.objects.clear();
  const auto found = by_scan_.find(scan);
  if (found != by_scan_.end()) frame.objects = found->second;
}

}  // namespace underbrush::perception
