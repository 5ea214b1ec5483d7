#include "underbrush/live/service.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/io/driver_layout.hpp"
#include "underbrush/live/live_sensors.hpp"
#include "underbrush/live/other_worlds.hpp"

namespace underbrush::live {
namespace {

static_assert(std::endian::native == std::endian::little, "columns are sent as they are");

template <class T>
constexpr const char* type_of() {
  if constexpr (std::is_same_v<T, float>) return "<f4";
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (std::is_same_v<T, uint8_t>) return "|u1";
  if constexpr (std::is_same_v<T, int8_t>) return "|i1";
  if constexpr (std::is_same_v<T, uint16_t>) return "<u2";
  if constexpr (std::is_same_v<T, int16_t>) return "<i2";
  if constexpr (std::is_same_v<T, uint32_t>) return "<u4";
  return "<i4";
}

/// Rows [begin, end) of a column of numbers or of vectors.
template <class T>
Column piece(const std::string& name, const std::vector<T>& values, size_t begin, size_t end) {
  Column out;
  out.name = name;
  if constexpr (std::is_arithmetic_v<T>) {
    out.type = type_of<T>();
  } else {
    out.type = type_of<typename T::Scalar>();
    out.width = uint32_t(T::SizeAtCompileTime);
  }
  static_assert(std::is_arithmetic_v<T> || sizeof(T) % 12 == 0, "three values without gaps");
  out.bytes.resize((end - begin) * sizeof(T));
  if (end > begin) {
    std::memcpy(out.bytes.data(), static_cast<const void*>(&values[begin]), out.bytes.size());
  }
  return out;
}

/// The rows [begin, end) of the column of that name. Throws `std::invalid_argument`.
Column piece_of(const std::string& name, const BeamLog& beams, size_t begin, size_t end) {
  const auto of = [&](const auto& values) { return piece(name, values, begin, end); };
  if (name == "range_m") return of(beams.range_m);
  if (name == "intensity") return of(beams.intensity);
  if (name == "time_s") return of(beams.time_s);
  if (name == "ring") return of(beams.ring);
  if (name == "scan") return of(beams.scan);
  if (name == "packet") return of(beams.packet);
  if (name == "origin") return of(beams.origin);
  if (name == "direction") return of(beams.direction);
  const auto extra = beams.extra.find(name);
  if (extra == beams.extra.end()) {
    throw std::invalid_argument("fire: the answer has no column " + in_quotes(name));
  }
  return std::visit(of, extra->second);
}

std::vector<std::string> usual_columns(const BeamLog& beams) {
  std::vector<std::string> out{"range_m", "intensity", "time_s", "ring"};
  if (beams.extra.contains(perception::kSensorColumn)) out.emplace_back(perception::kSensorColumn);
  return out;
}

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

class SensorService : public Service {
 public:
  SensorService(LiveSensors& sensors, const ServiceLimits& limits, OtherWorlds* others)
      : own_(std::shared_ptr<LiveSensors>(), &sensors), limits_(limits), others_(others) {}

  Description describe(const std::string& world) override {
    Description out;
    const std::shared_ptr<LiveSensors> sensors = sensors_in(world);
    for (size_t k = 0; k < sensors->sensors().size(); ++k) {
      const sensor::Sensor& s = sensors->sensors()[k];
      const perception::MountedSensor& m = sensors->rig().sensors[k];
      out.sensors.push_back({m.name, s.name, s.rate_hz, s.beams_per_s() / s.rate_hz, s.max_range_m,
                             m.vehicle_from_sensor});
    }
    for (const pipeline::NamedMover& m : sensors->world().movers()) {
      if (std::ranges::find(out.actors, m.name) == out.actors.end()) out.actors.push_back(m.name);
    }
    out.layouts = {"velodyne", "ouster", "autoware"};
    out.max_beams = limits_.beams;
    if (others_) out.worlds = others_->names();
    return out;
  }

  bool fire(const FireRequest& request, const Call& call) override {
    const Firing& f = request.firing;
    require(f.until_s - f.start_s <= limits_.duration_s,
            "fire: more than an hour from the start of the sensors to the end");
    const std::shared_ptr<LiveSensors> sensors = sensors_in(request.world);
    require(sensors->beams_in(f) <= double(limits_.beams),
            "fire: more beams than a firing may have");
    if (!request.layout.empty()) io::driver_layout_from_name(request.layout);
    require(
        std::set(request.columns.begin(), request.columns.end()).size() == request.columns.size(),
        "fire: a column is asked for twice");
    BeamLog beams;
    {
      std::unique_lock<std::timed_mutex> lock(firing_, std::defer_lock);
      if (!lock.try_lock_until(call.deadline) || call.is_cancelled()) return false;
      beams = sensors->fire(f);
    }
    return request.layout.empty() ? send_columns(request, beams, call)
                                  : send_clouds(request, *sensors, std::move(beams), call);
  }

 private:
  bool send_columns(const FireRequest& request, const BeamLog& beams, const Call& call) const {
    if (beams.empty()) return call.send({});
    const std::vector<std::string> names =
        request.columns.empty() ? usual_columns(beams) : request.columns;
    for (size_t begin = 0, end = 0; begin < beams.size(); begin = end) {
      end = std::min(beams.size(), begin + limits_.rows);
      Part part{begin, end - begin, {}, {}};
      for (const std::string& name : names)
        part.columns.push_back(piece_of(name, beams, begin, end));
      if (!call.send(std::move(part))) return false;
    }
    return true;
  }

  static bool send_clouds(const FireRequest& request, const LiveSensors& sensors, BeamLog beams,
                          const Call& call) {
    const Firing& f = request.firing;
    const Trajectory path = trajectory_of(f.vehicle, f.until_s);
    std::vector<BeamLog> of_sensor = by_sensor(std::move(beams), sensors.sensors().size());
    for (size_t k = 0; k < sensors.sensors().size(); ++k) {
      const perception::MountedSensor& mounted = sensors.rig().sensors[k];
      std::vector<StampedPose> poses = path.poses();
      for (StampedPose& p : poses) {
        p.world_from_sensor = p.world_from_sensor * mounted.vehicle_from_sensor;
      }
      Part part;
      part.clouds.push_back(cloud_of(std::move(of_sensor[k]),
                                     io::driver_layout_from_name(request.layout),
                                     Trajectory(std::move(poses)), f.from_s));
      part.clouds[0].sensor = mounted.name;
      part.rows = uint64_t(part.clouds[0].height) * part.clouds[0].width;
      if (!call.send(std::move(part))) return false;
    }
    return true;
  }

  std::shared_ptr<LiveSensors> sensors_in(const std::string& world) {
    if (world.empty()) return own_;
    require(others_ != nullptr, "the server has no folder of worlds");
    try {
      return others_->sensors(world);
    } catch (const FormatError& e) {  // What carries the service knows no types of the library.
      throw std::invalid_argument(e.what());
    }
  }

  std::shared_ptr<LiveSensors> own_;  ///< Does not own them.
  ServiceLimits limits_;
  OtherWorlds* others_;
  std::timed_mutex firing_;
};

}  // namespace

std::unique_ptr<Service> service_of(LiveSensors& sensors, const ServiceLimits& limits,
                                    OtherWorlds* others) {
  return std::make_unique<SensorService>(sensors, limits, others);
}

}  // namespace underbrush::live
