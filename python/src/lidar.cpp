/// \file
/// Live sensors in a world.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bind.hpp"
#include "poses.hpp"
#include "prepared_world.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/live/clouds.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;
namespace {

constexpr double kSameTime = 1e-9;

/// Poses at the end of a firing, or motions over its time; nothing for absent actors.
using GivenActors =
    std::map<std::string, std::optional<std::variant<Pose, Eigen::Matrix4d, Trajectory>>>;
using Paths = std::map<std::string, std::vector<StampedPose>>;

live::LiveSensors opened(pipeline::TracedWorld& world, const pipeline::SimulateOptions& options,
                         const sensor::Sensor* sensor,
                         const std::optional<std::filesystem::path>& rig) {
  require(rig.has_value() == !sensor, "Lidar: give a sensor or a rig");
  if (sensor) return {world, options, *sensor};
  return {world, options, perception::load_rig(*rig)};
}

/// The motion of an actor that is not absent during a firing. Its earlier poses in `path` tell how
/// it came to a given pose.
live::Motion motion_of(const std::variant<Pose, Eigen::Matrix4d, Trajectory>& given,
                       const live::Firing& firing, std::vector<StampedPose>& path) {
  if (const auto* motion = std::get_if<Trajectory>(&given)) {
    path = motion->poses();
    return {path};
  }
  const auto* matrix = std::get_if<Eigen::Matrix4d>(&given);
  if (!path.empty() && path.back().time_s > firing.from_s + kSameTime) path.clear();
  if (path.size() > 2) path.erase(path.begin(), path.end() - 2);
  path.push_back({firing.until_s, matrix ? pose_from_matrix(*matrix) : std::get<Pose>(given)});
  return {path};
}

/// The motions of actors during a firing.
std::vector<live::ActorMotion> motions_of(const GivenActors& actors, const live::Firing& firing,
                                          Paths& paths) {
  std::vector<live::ActorMotion> out;
  for (const auto& [name, given] : actors) {
    out.push_back({name, {}, !given});
    given ? void(out.back().motion = motion_of(*given, firing, paths[name]))
          : void(paths.erase(name));
  }
  return out;
}

/// Sensors that fire on request.
class Lidar {
 public:
  Lidar(const GivenWorld& world, const SimulateOptions& options, const sensor::Sensor* sensor,
        const std::optional<std::filesystem::path>& rig)
      : target_(world, options), sensors_(opened(target_.world(), options.pipeline, sensor, rig)) {
    require(options.files.waveforms.empty() && options.files.profile.empty(),
            "Lidar: waveforms and profile are of simulate");
  }

  /// Answers the beams of the revolution that starts at `time_s`.
  BeamLog scan(const Pose& from, const Pose& to, double time_s, const GivenActors& actors) {
    const std::lock_guard lock(mutex_);
    last_.reset();
    BeamLog out = fired(from, to, time_s, time_s + 1 / sensor().rate_hz, actors);
    last_.reset();
    return out;
  }

  /// Answers the beams from `time_s` to `until_s`, which go on with those of the last call if they
  /// begin where those ended.
  BeamLog fire(const Pose& from, const Pose& to, double time_s, double until_s,
               const GivenActors& actors) {
    const std::lock_guard lock(mutex_);
    return fired(from, to, time_s, until_s, actors);
  }

  /// The same as the point cloud of each sensor.
  std::vector<live::PointCloud> fire_clouds(const Pose& from, const Pose& to, double time_s,
                                            double until_s, const GivenActors& actors,
                                            const std::string& layout) {
    const io::DriverLayout packed = io::driver_layout_from_name(layout);
    const std::lock_guard lock(mutex_);
    BeamLog beams = fired(from, to, time_s, until_s, actors);
    return live::clouds_of(sensors_, *last_, std::move(beams), packed);
  }

  void reset() {
    const std::lock_guard lock(mutex_);
    scans_ = 0;
    beams_ = 0;
    paths_.clear();
    last_.reset();
  }
  const sensor::Sensor& sensor() const { return sensors_.sensors()[0]; }
  const live::LiveSensors& sensors() const { return sensors_; }
  uint32_t scans() const { return scans_; }

 private:
  static size_t beams_of(const BeamLog& log) {
    const std::vector<bool> begins = begins_beam(log);
    return size_t(std::count(begins.begin(), begins.end(), true));
  }

  BeamLog fired(const Pose& from, const Pose& to, double time_s, double until_s,
                const GivenActors& actors) {
    const bool goes_on = last_ && std::abs(time_s - last_->until_s) < kSameTime;
    live::Firing f = goes_on ? *last_ : live::Firing{time_s, 0, time_s, {}, {}, beams_, scans_};
    f.from_s = f.until_s;
    f.until_s = until_s;
    // The pose before the last one tells how the sensor came here.
    std::vector<StampedPose>& poses = f.vehicle.poses;
    if (goes_on) poses = {poses.end()[-2]};
    poses.push_back({f.from_s, from});
    poses.push_back({f.until_s, to});
    Paths paths = paths_;
    f.actors = motions_of(actors, f, paths);
    BeamLog out = sensors_.fire(f);
    constexpr double kPart = 1e-6;  // of a revolution, less than which is an error of rounding
    scans_ = f.first_scan + uint32_t(std::ceil((f.until_s - f.start_s) * sensor().rate_hz - kPart));
    beams_ += beams_of(out);
    paths_ = std::move(paths);
    last_ = std::move(f);
    return out;
  }

  std::mutex mutex_;
  PreparedWorld target_;
  live::LiveSensors sensors_;
  uint32_t scans_ = 0;
  size_t beams_ = 0;
  Paths paths_;                       ///< The last poses of actors that were given poses.
  std::optional<live::Firing> last_;  ///< What `fire` did, if it was called last.
};

void bind_point_cloud(nb::module_& m) {
  using C = live::PointCloud;
  nb::class_<C>(m, "PointCloud",
                "The beams of a sensor as in sensor_msgs/PointCloud2, little-endian, in its frame.")
      .def_ro("sensor", &C::sensor, "The sensor's name in the rig.")
      .def_prop_ro(
          "time_s", [](const C& c) { return c.world_from_sensor.time_s; },
          "The beginning of the firing, s.")
      .def_prop_ro(
          "world_from_sensor", [](const C& c) { return c.world_from_sensor.world_from_sensor; },
          "The pose of the sensor at that time.")
      .def_ro("height", &C::height)
      .def_ro("width", &C::width)
      .def_ro("point_step", &C::point_step, "Bytes of a point.")
      .def_prop_ro(
          "fields",
          [](const C& c) {
            std::vector<std::tuple<std::string, uint32_t, uint32_t>> out;
            for (const live::PointField& f : c.fields)
              out.emplace_back(f.name, f.offset, f.datatype);
            return out;
          },
          "Name, offset and datatype of each field, as in sensor_msgs/PointField.")
      .def_prop_ro(
          "data", [](const C& c) { return nb::bytes(c.bytes.data(), c.bytes.size()); },
          "The bytes of the points; a copy.");
}

}  // namespace

void bind_lidar(nb::module_& m) {
  bind_point_cloud(m);
  using Rig = std::optional<std::filesystem::path>;
  nb::class_<Lidar>(m, "LidarCore", "Live sensors in a world.")
      .def(
          "__init__",
          [](Lidar* l, const GivenWorld& world, const SimulateOptions& options,
             const sensor::Sensor* sensor, const Rig& rig) {
            const nb::gil_scoped_release released;
            new (l) Lidar(world, options, sensor, rig);
          },
          "world"_a, "options"_a, "sensor"_a.none(), "rig"_a.none(), nb::keep_alive<1, 2>())
      .def(
          "scan",
          [](Lidar& l, const GivenPose& from, const GivenPose& to, double time_s,
             const GivenActors& actors) {
            const Pose a = pose_of(from), b = pose_of(to);
            const nb::gil_scoped_release released;
            return l.scan(a, b, time_s, actors);
          },
          "pose_from"_a, "pose_to"_a, "time"_a, "actors"_a)
      .def(
          "fire",
          [](Lidar& l, const GivenPose& from, const GivenPose& to, double time_s, double until_s,
             const GivenActors& actors) {
            const Pose a = pose_of(from), b = pose_of(to);
            const nb::gil_scoped_release released;
            return l.fire(a, b, time_s, until_s, actors);
          },
          "pose_from"_a, "pose_to"_a, "time"_a, "until"_a, "actors"_a)
      .def(
          "fire_clouds",
          [](Lidar& l, const GivenPose& from, const GivenPose& to, double time_s, double until_s,
             const GivenActors& actors, const std::string& layout) {
            const Pose a = pose_of(from), b = pose_of(to);
            const nb::gil_scoped_release released;
            return l.fire_clouds(a, b, time_s, until_s, actors, layout);
          },
          "pose_from"_a, "pose_to"_a, "time"_a, "until"_a, "actors"_a, "layout"_a)
      .def("reset", &Lidar::reset)
      .def_prop_ro("sensor", &Lidar::sensor, nb::rv_policy::reference_internal)
      .def_prop_ro("sensors",
                   [](const Lidar& l) {
                     nb::typed<nb::dict, std::string, sensor::Sensor> out;
                     for (size_t k = 0; k < l.sensors().sensors().size(); ++k) {
                       out[l.sensors().rig().sensors[k].name.c_str()] = l.sensors().sensors()[k];
                     }
                     return out;
                   })
      .def_prop_ro("actors", [](const Lidar& l) { return l.sensors().actors(); })
      .def_prop_ro("scans", &Lidar::scans);
}

}  // namespace underbrush::python
