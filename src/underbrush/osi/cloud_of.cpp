#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/osi/profile.hpp"
#include "underbrush/osi/strategies.hpp"

namespace underbrush::osi {
namespace {

Pose mounting_of(const SensorData& data, size_t lidar) {
  if (lidar < data.lidar.size() && data.lidar[lidar].header.mounting) {
    return data.lidar[lidar].header.mounting->pose();
  }
  return data.mounting ? data.mounting->pose() : Pose{};
}

// The beams of each lidar that a view describes and that made no detection.
void add_misses(const SensorData& data, double axle_height_m, double reach_m,
                perception::MergedCloud& cloud) {
  size_t lidar = 0;
  for (const auto& view : data.views) {
    for (const LidarSensorView& l : view->lidar) {
      const size_t k = lidar++;
      if (k >= data.lidar.size() || !l.configuration || l.configuration->directions.empty()) {
        continue;
      }
      const LidarConfiguration& c = *l.configuration;
      const size_t per_beam = c.beams && *c.beams && c.directions.size() % *c.beams == 0
                                  ? c.directions.size() / *c.beams
                                  : 1;
      std::vector<uint8_t> hit(c.directions.size() / per_beam, 0);
      for (const LidarDetection& d : data.lidar[k].detections) {
        if (d.beam_id < hit.size()) hit[d.beam_id] = 1;
      }
      const Pose mounting = mounting_of(data, k);
      for (size_t b = 0; b < hit.size(); ++b) {
        if (hit[b]) continue;
        Vec3 end = mounting * Vec3(reach_m * c.directions[b * per_beam].cast<double>());
        end.z() += axle_height_m;
        cloud.miss_m.push_back(end.cast<float>());
        cloud.miss_sensor.push_back(uint16_t(k));
      }
    }
  }
}

}  // namespace

void cloud_of(const SensorData& data, double axle_height_m, bool misses, double reach_m,
              perception::MergedCloud& cloud) {
  require_data(data.logical.has_value(), "there are no logical detections; run alignment before");
  const LogicalDetectionData& logical = *data.logical;
  cloud.clear();
  cloud.sensor_m.clear();
  cloud.time_s = cloud.available_s = measured_s(data);
  cloud.world_from_vehicle = world_from_ground(data, axle_height_m);
  const Pose vehicle_from_virtual = data.mounting ? data.mounting->pose() : Pose{};
  const size_t sensors = std::max<size_t>(1, logical.sensor_ids.size());
  for (size_t k = 0; k < sensors; ++k) {
    Vec3 place = mounting_of(data, k).translation;
    place.z() += axle_height_m;
    cloud.sensor_m.push_back(place.cast<float>());
  }
  for (const LogicalDetection& d : logical.detections) {
    Vec3 p = vehicle_from_virtual * d.position_m;
    p.z() += axle_height_m;
    const auto at = std::find(logical.sensor_ids.begin(), logical.sensor_ids.end(), d.sensor_id);
    const auto sensor =
        at == logical.sensor_ids.end() ? 0 : uint16_t(at - logical.sensor_ids.begin());
    cloud.point_m.push_back(p.cast<float>());
    cloud.stamp_s.push_back(cloud.time_s);
    cloud.intensity.push_back(float(d.intensity_percent));
    cloud.ring.push_back(0);
    cloud.sensor.push_back(uint16_t(sensor));
  }
  if (misses) add_misses(data, axle_height_m, reach_m, cloud);
}

}  // namespace underbrush::osi
