#include "underbrush/live/service.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/live/clouds.hpp"
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

class SensorService : public Service {
 public:
  SensorService(LiveSensors& sensors, const ServiceLimits& limits, OtherWorlds* others)
      : own_(std::shared_ptr<LiveSensors>(), &sensors), limits_(limits), others_(others) {}

  std::optional<Description> describe(const std::string& world, Deadline deadline) override {
    Description out;
    const std::shared_ptr<LiveSensors> sensors = sensors_in(world, deadline);
    if (!sensors) return {};
    for (size_t k = 0; k < sensors->sensors().size(); ++k) {
      const sensor::Sensor& s = sensors->sensors()[k];
      const perception::MountedSensor& m = sensors->rig().sensors[k];
      out.sensors.push_back({m.name, s.name, s.rate_hz, s.beams_per_s() / s.rate_hz, s.max_range_m,
                             m.vehicle_from_sensor});
    }
    out.actors = sensors->actors();
    out.layouts = {"velodyne", "ouster", "autoware"};
    out.max_beams = limits_.beams;
    if (others_) out.worlds = others_->names();
    return out;
  }

  bool fire(const FireRequest& request, const Call& call) override {
    const Firing& f = request.firing;
    require(f.until_s - f.start_s <= limits_.duration_s,
            "fire: more than an hour from the start of the sensors to the end");
    const std::shared_ptr<LiveSensors> sensors = sensors_in(request.world, call.deadline);
    if (!sensors) return false;
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
    if (request.layout.empty()) return send_columns(request, beams, call);
    const io::DriverLayout layout = io::driver_layout_from_name(request.layout);
    return send_clouds(clouds_of(*sensors, f, std::move(beams), layout), call);
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

  static bool send_clouds(std::vector<PointCloud> clouds, const Call& call) {
    return std::ranges::all_of(clouds, [&](PointCloud& cloud) {
      Part part;
      part.rows = uint64_t(cloud.height) * cloud.width;
      part.clouds.push_back(std::move(cloud));
      return call.send(std::move(part));
    });
  }

  /// The sensors in a world; null where it is not open at the deadline.
  std::shared_ptr<LiveSensors> sensors_in(const std::string& world, Deadline deadline) {
    if (world.empty()) return own_;
    require(others_ != nullptr, "the server has no folder of worlds");
    try {
      return others_->sensors(world, deadline);
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
