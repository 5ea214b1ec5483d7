#include "underbrush/perception/cycles.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

Rig single(const LogInfo& info, double height_m) {
  MountedSensor m{"sensor", info.sensor, {}, 0, 0};
  m.vehicle_from_sensor.translation.z() = height_m;
  return {"log", {m}};
}

// The scans of a log that does not say where they were made.
std::vector<ScanInfo> scans_of_beams(BeamSource& source) {
  std::vector<ScanInfo> scans;
  source.rewind();
  for (BeamLog chunk; source.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!scans.empty() && scans.back().scan == chunk.scan[i]) continue;
      Pose pose;
      pose.translation = chunk.origin[i];
      scans.push_back({chunk.scan[i], chunk.time_s[i], pose});
    }
  }
  return scans;
}

Trajectory vehicle_path(const std::vector<ScanInfo>& scans, const Pose& scan_from_vehicle) {
  std::vector<StampedPose> poses;
  poses.reserve(scans.size());
  for (const ScanInfo& s : scans) {
    poses.push_back({s.time_s, s.world_from_sensor * scan_from_vehicle});
  }
  std::vector<double> times;
  for (const StampedPose& p : poses) {
    require_data(std::isfinite(p.time_s), "perception: the time of a scan is not finite");
    times.push_back(p.time_s);
  }
  std::sort(times.begin(), times.end());
  require_data(std::adjacent_find(times.begin(), times.end()) == times.end(),
               "perception: two scans have one time, or a scan comes twice");
  return Trajectory(std::move(poses));
}

// The middle one of the times between scans.
double period_of(const Trajectory& path) {
  std::vector<double> steps;
  for (size_t k = 1; k < path.poses().size(); ++k) {
    steps.push_back(path.poses()[k].time_s - path.poses()[k - 1].time_s);
  }
  if (steps.empty()) return 0;
  std::nth_element(steps.begin(), steps.begin() + std::ptrdiff_t(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

}  // namespace

CycleReader::CycleReader(BeamSource& source, std::optional<Rig> rig, const CycleOptions& options)
    : source_(source),
      options_(options),
      is_rig_(rig.has_value()),
      alignment_(is_rig_ ? std::move(*rig) : single(source.info(), options.sensor_height_m),
                 options.alignment) {
  scans_ = source.info().scans;
  is_deskewed_ = source.info().deskewed && !scans_.empty();
  if (scans_.empty()) scans_ = scans_of_beams(source);
  require_data(!scans_.empty(), "perception: the log has no beams");
  const Pose mount = alignment_.rig().sensors[0].vehicle_from_sensor;
  path_ = vehicle_path(scans_, is_rig_ ? Pose{} : mount.inverse());
  cycle_s_ = period_of(path_);
  clouds_.resize(alignment_.rig().sensors.size());
  for (size_t s = 0; s < clouds_.size(); ++s) clouds_[s].sensor = uint16_t(s);
  source_.rewind();
}

const ScanInfo& CycleReader::info_of(uint32_t scan) const {
  const auto at = std::find_if(scans_.begin(), scans_.end(),
                               [scan](const ScanInfo& s) { return s.scan == scan; });
  require_data(at != scans_.end(), "perception: a beam's scan has no pose");
  return *at;
}

bool CycleReader::fill() {
  while (at_ == chunk_.size()) {
    at_ = 0;
    if (!source_.next(chunk_)) {
      chunk_.resize(0);
      return false;
    }
    const auto column = chunk_.extra.find(kSensorColumn);
    sensor_ =
        column == chunk_.extra.end() ? nullptr : std::get_if<std::vector<uint8_t>>(&column->second);
    require_data(is_rig_ == (sensor_ != nullptr),
                 is_rig_ ? "perception: the log has no column 'sensor', so it is not of a rig"
                         : "perception: the log is of several sensors: name their rig");
  }
  return true;
}

// A point goes back to its sensor's frame at its own time.
void CycleReader::add(size_t i, const ScanInfo& info) {
  const size_t k = sensor_ ? (*sensor_)[i] : 0;
  require_data(k < clouds_.size(), "perception: a beam's sensor is not in the rig");
  const MountedSensor& m = alignment_.rig().sensors[k];
  const bool is_hit = chunk_.is_hit(i);
  if (is_hit && double(chunk_.range_m[i]) < options_.min_range_m) return;
  const double t = is_deskewed_ ? chunk_.time_s[i] : info.time_s;
  const auto pose = path_.at(t);
  require_data(pose.has_value(), "perception: a beam is too far in time from the poses of scans");
  const Pose sensor_from_world = (*pose * m.vehicle_from_sensor).inverse();
  const Vec3f p = (sensor_from_world * chunk_.end_point(i)).cast<float>();
  SensorCloud& cloud = clouds_[k];
  if (!is_hit) {
    cloud.miss_m.push_back(p);
    cloud.miss_time_s.push_back(t + m.clock_offset_s);
    return;
  }
  cloud.point_m.push_back(p);
  cloud.time_s.push_back(t + m.clock_offset_s);
  cloud.intensity.push_back(chunk_.intensity[i]);
  cloud.ring.push_back(chunk_.ring[i]);
}

bool CycleReader::next(MergedCloud& cloud) {
  if (!fill()) return false;
  scan_ = chunk_.scan[at_];
  const ScanInfo& info = info_of(scan_);
  world_from_scan_ = info.world_from_sensor;
  for (SensorCloud& c : clouds_) c.clear();
  while (fill() && chunk_.scan[at_] == scan_) add(at_++, info);
  alignment_.merge(clouds_, path_, info.time_s, cloud);
  return true;
}

}  // namespace underbrush::perception
