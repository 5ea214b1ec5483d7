#include "underbrush/perception/alignment.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {
namespace {

/// The vehicle's motion: it gives the pose at t₀ from that at a time, and remembers the last one,
/// because many points share their time.
class Motion {
 public:
  Motion(const Trajectory& world_from_vehicle, double time_s, bool deskew)
      : path_(world_from_vehicle), deskew_(deskew && !world_from_vehicle.empty()) {
    now_ = pose(time_s);
    back_ = now_.inverse();
  }
  const Pose& world_from_vehicle() const { return now_; }
  /// The vehicle's frame at t₀ from that at a time.
  const Pose& now_from(double time_s) {
    if (deskew_ && !(known_ && time_s == last_s_)) {
      last_ = back_ * pose(time_s);
      last_s_ = time_s;
      known_ = true;
    }
    return last_;
  }

 private:
  Pose pose(double time_s) const {
    if (path_.empty()) return {};
    const auto found = path_.at(time_s);
    require(found.has_value(), "the vehicle's trajectory has no pose for a point's time");
    return *found;
  }

  const Trajectory& path_;
  bool deskew_, known_ = false;
  Pose now_, back_, last_;
  double last_s_ = 0;
};

}  // namespace

Alignment::Alignment(Rig rig, const AlignmentOptions& options)
    : rig_(std::move(rig)), options_(options) {
  require(!rig_.sensors.empty(), "a rig needs a sensor");
}

void Alignment::merge(std::span<const SensorCloud> clouds, const Trajectory& world_from_vehicle,
                      double time_s, MergedCloud& merged) {
  merged.clear();
  order_.clear();
  for (uint32_t c = 0; c < clouds.size(); ++c) {
    clouds[c].check();
    require(clouds[c].sensor < rig_.sensors.size(), "a cloud's sensor is not in the rig");
    const double offset = rig_.sensors[clouds[c].sensor].clock_offset_s;
    for (uint32_t i = 0; i < clouds[c].size(); ++i) {
      order_.push_back({clouds[c].time_s[i] - offset, c, i});
    }
  }
  std::sort(order_.begin(), order_.end(), [&](const Entry& a, const Entry& b) {
    return std::tuple(a.time_s, clouds[a.cloud].sensor, a.cloud, a.index) <
           std::tuple(b.time_s, clouds[b.cloud].sensor, b.cloud, b.index);
  });
  Motion motion(world_from_vehicle, time_s, options_.deskew);
  merged.time_s = merged.available_s = time_s;
  merged.world_from_vehicle = motion.world_from_vehicle();
  merged.sensor_m.clear();
  for (const MountedSensor& m : rig_.sensors) {
    merged.sensor_m.push_back(m.vehicle_from_sensor.translation.cast<float>());
  }
  const auto moved = [&](const Vec3f& point, uint16_t sensor, double at_s) -> Vec3f {
    const Vec3 p = rig_.sensors[sensor].vehicle_from_sensor * point.cast<double>();
    return (motion.now_from(at_s) * p).cast<float>();
  };
  for (const Entry& e : order_) {
    const SensorCloud& cloud = clouds[e.cloud];
    merged.point_m.push_back(moved(cloud.point_m[e.index], cloud.sensor, e.time_s));
    merged.stamp_s.push_back(e.time_s);
    merged.intensity.push_back(cloud.intensity[e.index]);
    merged.ring.push_back(cloud.ring[e.index]);
    merged.sensor.push_back(cloud.sensor);
    merged.available_s =
        std::max(merged.available_s, e.time_s + rig_.sensors[cloud.sensor].latency_s);
  }
  for (const SensorCloud& cloud : clouds) {
    const double offset = rig_.sensors[cloud.sensor].clock_offset_s;
    for (size_t i = 0; i < cloud.miss_m.size(); ++i) {
      merged.miss_m.push_back(moved(cloud.miss_m[i], cloud.sensor, cloud.miss_time_s[i] - offset));
      merged.miss_sensor.push_back(cloud.sensor);
    }
  }
}

}  // namespace underbrush::perception
