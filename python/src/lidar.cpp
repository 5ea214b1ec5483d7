/// \file
/// A live sensor in a world.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/variant.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "bind.hpp"
#include "poses.hpp"
#include "prepared_world.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/live/live_sensors.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;
namespace {

/// A sensor that fires one revolution or frame a call.
class Lidar {
 public:
  Lidar(const GivenWorld& world, sensor::Sensor sensor, const SimulateOptions& options)
      : target_(world, options), sensors_(target_.world(), options.pipeline, std::move(sensor)) {
    require(options.files.waveforms.empty() && options.files.profile.empty(),
            "Lidar: waveforms and profile are of simulate");
  }

  /// Answers the beams of the revolution that starts at `time_s`.
  BeamLog scan(const Pose& from, const Pose& to, double time_s) {
    const std::lock_guard lock(mutex_);
    last_.reset();
    const double end_s = time_s + 1 / sensor().rate_hz;
    const live::Motion path{{{time_s, from}, {end_s, to}}};
    BeamLog out = sensors_.fire({time_s, time_s, end_s, path, {}, beams_, scans_});
    ++scans_;
    beams_ += beams_of(out);
    return out;
  }

  /// Answers the beams from `time_s` to `until_s`, which go on with those of the last call if they
  /// begin where those ended.
  BeamLog fire(const Pose& from, const Pose& to, double time_s, double until_s) {
    constexpr double kSameTime = 1e-9;
    const std::lock_guard lock(mutex_);
    const bool goes_on = last_ && std::abs(time_s - last_->until_s) < kSameTime;
    live::Firing f = goes_on ? *last_ : live::Firing{time_s, 0, time_s, {}, {}, beams_, scans_};
    f.from_s = f.until_s;
    f.until_s = until_s;
    // The pose before the last one tells how the sensor came here.
    std::vector<StampedPose>& poses = f.vehicle.poses;
    if (goes_on) poses = {poses.end()[-2]};
    poses.push_back({f.from_s, from});
    poses.push_back({f.until_s, to});
    BeamLog out = sensors_.fire(f);
    constexpr double kPart = 1e-6;  // of a revolution, less than which is an error of rounding
    scans_ = f.first_scan + uint32_t(std::ceil((f.until_s - f.start_s) * sensor().rate_hz - kPart));
    beams_ += beams_of(out);
    last_ = std::move(f);
    return out;
  }

  void reset() {
    const std::lock_guard lock(mutex_);
    scans_ = 0;
    beams_ = 0;
    last_.reset();
  }
  const sensor::Sensor& sensor() const { return sensors_.sensors()[0]; }
  uint32_t scans() const { return scans_; }

 private:
  static size_t beams_of(const BeamLog& log) {
    const std::vector<bool> begins = begins_beam(log);
    return size_t(std::count(begins.begin(), begins.end(), true));
  }

  std::mutex mutex_;
  PreparedWorld target_;
  live::LiveSensors sensors_;
  uint32_t scans_ = 0;
  size_t beams_ = 0;
  std::optional<live::Firing> last_;  ///< What `fire` did, if it was called last.
};

}  // namespace

void bind_lidar(nb::module_& m) {
  nb::class_<Lidar>(m, "LidarCore", "A live sensor in a world.")
      .def(
          "__init__",
          [](Lidar* l, const GivenWorld& world, const sensor::Sensor& sensor,
             const SimulateOptions& options) {
            const nb::gil_scoped_release released;
            new (l) Lidar(world, sensor, options);
          },
          "world"_a, "sensor"_a, "options"_a, nb::keep_alive<1, 2>())
      .def(
          "scan",
          [](Lidar& l, const GivenPose& from, const GivenPose& to, double time_s) {
            const Pose a = pose_of(from), b = pose_of(to);
            const nb::gil_scoped_release released;
            return l.scan(a, b, time_s);
          },
          "pose_from"_a, "pose_to"_a, "time"_a)
      .def(
          "fire",
          [](Lidar& l, const GivenPose& from, const GivenPose& to, double time_s, double until_s) {
            const Pose a = pose_of(from), b = pose_of(to);
            const nb::gil_scoped_release released;
            return l.fire(a, b, time_s, until_s);
          },
          "pose_from"_a, "pose_to"_a, "time"_a, "until"_a)
      .def("reset", &Lidar::reset)
      .def_prop_ro("sensor", &Lidar::sensor, nb::rv_policy::reference_internal)
      .def_prop_ro("scans", &Lidar::scans);
}

}  // namespace underbrush::python
