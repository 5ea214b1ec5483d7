#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/strategies.hpp"

namespace underbrush::osi {
namespace {

Vec3 place_of(const LidarDetection& d) {
  const double flat = d.distance_m * std::cos(d.elevation_rad);
  return {flat * std::cos(d.azimuth_rad), flat * std::sin(d.azimuth_rad),
          d.distance_m * std::sin(d.elevation_rad)};
}

/// When each ray of a lidar was fired, or null.
const LidarConfiguration* rays_of(const SensorData& data, size_t lidar) {
  for (const auto& view : data.views) {
    if (lidar < view->lidar.size()) {
      const auto& c = view->lidar[lidar].configuration;
      return c && !c->timings_us.empty() ? &*c : nullptr;
    }
    lidar -= view->lidar.size();
  }
  return nullptr;
}

/// Moves the detections of all lidars to the frame of the virtual sensor.
class AlignmentStep : public Strategy {
 public:
  explicit AlignmentStep(bool deskew) : deskew_(deskew) {}

  void step(SensorData& data) override {
    require_data(!data.lidar.empty(), "alignment: there are no detections of a lidar");
    LogicalDetectionData& out = data.logical.emplace();
    out.time = data.last_measurement_time;
    out.qualifier = DataQualifier::kAvailable;
    for (size_t k = 0; k < data.lidar.size(); ++k) add(data, k, out);
    out.valid_detections = uint32_t(out.detections.size());
  }
  void reset() override {}
  std::unique_ptr<Strategy> clone() const override {
    return std::make_unique<AlignmentStep>(*this);
  }

 private:
  void add(const SensorData& data, size_t lidar, LogicalDetectionData& out) const;

  bool deskew_;
};

void AlignmentStep::add(const SensorData& data, size_t lidar, LogicalDetectionData& out) const {
  const LidarDetectionData& l = data.lidar[lidar];
  const Pose vehicle_from_virtual = data.mounting ? data.mounting->pose() : Pose{};
  const Pose vehicle_from_lidar =
      l.header.mounting ? l.header.mounting->pose() : vehicle_from_virtual;
  const Pose virtual_from_vehicle = vehicle_from_virtual.inverse();
  const uint64_t id = l.header.sensor_id.value_or(lidar);
  out.sensor_ids.push_back(id);
  const LidarConfiguration* rays = deskew_ ? rays_of(data, lidar) : nullptr;
  const size_t per_beam =
      rays && rays->beams && *rays->beams ? rays->timings_us.size() / *rays->beams : 1;
  Vec3 velocity = Vec3::Zero();  // In the vehicle's own frame.
  double yaw_rate = 0;
  if (rays && data.host) {
    velocity =
        data.host->pose().rotation.conjugate() * data.host->velocity_m_s.value_or(Vec3::Zero());
    yaw_rate = data.host->turn_rate_rad_s.value_or(Vec3::Zero()).z();
  }
  out.detections.reserve(out.detections.size() + l.detections.size());
  for (const LidarDetection& d : l.detections) {
    Vec3 p = vehicle_from_lidar * place_of(d);
    if (rays && d.beam_id < rays->timings_us.size() / per_beam) {
      const double t = 1e-6 * double(rays->timings_us[d.beam_id * per_beam]);
      p = Eigen::AngleAxisd(yaw_rate * t, Vec3::UnitZ()) * p + t * velocity;
    }
    out.detections.push_back({d.existence, d.object_id, virtual_from_vehicle * p,
                              d.intensity_percent, d.pulse_width_m, id});
  }
}

}  // namespace

std::unique_ptr<Strategy> make_alignment(Parameters& p) {
  return std::make_unique<AlignmentStep>(p.flag("deskew", false));
}

double measured_s(const SensorData& data) {
  if (data.last_measurement_time) return data.last_measurement_time->s();
  require_data(data.timestamp.has_value(), "the data have no time");
  return data.timestamp->s();
}

Pose world_from_ground(const SensorData& data, double axle_height_m) {
  Pose p = data.host ? data.host->pose() : Pose{};
  p.translation = p * Vec3(0, 0, -axle_height_m);
  return p;
}

}  // namespace underbrush::osi
