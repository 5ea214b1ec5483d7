#include "underbrush/live/clouds.hpp"

namespace underbrush::live {
namespace {

/// The numbers of types of fields in sensor_msgs/PointField.
uint32_t datatype_of(const io::CloudField& f) {
  constexpr uint32_t kFloat32 = 7, kUint8 = 2, kUint16 = 4, kUint32 = 6;
  if (f.is_float) return kFloat32;
  return f.bytes == 1 ? kUint8 : f.bytes == 2 ? kUint16 : kUint32;
}

PointCloud cloud_of(BeamLog beams, io::DriverLayout layout, const Trajectory& world_from_sensor,
                    double from_s) {
  PointCloud out;
  out.world_from_sensor = {from_s, world_from_sensor.at(from_s).value_or(Pose())};
  const ScanInfo scan{0, from_s, out.world_from_sensor.world_from_sensor};
  io::DriverCloud cloud = io::driver_cloud(std::move(beams), layout, scan, world_from_sensor);
  for (const io::CloudField& f : io::fields_of(layout)) {
    out.fields.push_back({f.name, out.point_step, datatype_of(f)});
    out.point_step += f.bytes;
  }
  out.height = uint32_t(cloud.height);
  out.width = uint32_t(cloud.width);
  out.bytes = std::move(cloud.points);
  return out;
}

/// Splits beams by the sensors of a rig; those of a single sensor are taken over.
std::vector<BeamLog> by_sensor(BeamLog beams, size_t sensors) {
  std::vector<BeamLog> out(sensors);
  const auto found = beams.extra.find(perception::kSensorColumn);
  if (found == beams.extra.end()) {
    out.at(0) = std::move(beams);
    return out;
  }
  const auto& sensor = std::get<std::vector<uint8_t>>(found->second);
  for (BeamLog& part : out) part = beams.like();
  for (size_t begin = 0, end = 0; begin < beams.size(); begin = end) {
    while (end < beams.size() && sensor[end] == sensor[begin]) ++end;
    out[sensor[begin]].append(beams, begin, end);
  }
  return out;
}

}  // namespace

std::vector<PointCloud> clouds_of(const LiveSensors& sensors, const Firing& firing, BeamLog beams,
                                  io::DriverLayout layout) {
  std::vector<PointCloud> out;
  const Trajectory path = trajectory_of(firing.vehicle, firing.until_s);
  std::vector<BeamLog> of_sensor = by_sensor(std::move(beams), sensors.sensors().size());
  for (size_t k = 0; k < of_sensor.size(); ++k) {
    const perception::MountedSensor& mounted = sensors.rig().sensors[k];
    std::vector<StampedPose> poses = path.poses();
    for (StampedPose& p : poses) {
      p.world_from_sensor = p.world_from_sensor * mounted.vehicle_from_sensor;
    }
    out.push_back(
        cloud_of(std::move(of_sensor[k]), layout, Trajectory(std::move(poses)), firing.from_s));
    out.back().sensor = mounted.name;
  }
  return out;
}

}  // namespace underbrush::live
