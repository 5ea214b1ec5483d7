/// \file
/// A live sensor in a world.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/variant.h>

#include <algorithm>
#include <mutex>

#include "bind.hpp"
#include "fired_into.hpp"
#include "poses.hpp"
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
    require(options.waveforms.empty(), "Lidar: waveforms are of simulate");
  }

  /// Answers the beams of the revolution that starts at `time_s`.
  BeamLog scan(const Pose& from, const Pose& to, double time_s) {
    const std::lock_guard lock(mutex_);
    const double end_s = time_s + 1 / sensor().rate_hz;
    const live::Motion path{{{time_s, from}, {end_s, to}}};
    BeamLog out = sensors_.fire({time_s, time_s, end_s, path, {}, beams_, scans_});
    const std::vector<bool> begins = begins_beam(out);
    ++scans_;
    beams_ += size_t(std::count(begins.begin(), begins.end(), true));
    return out;
  }

  void reset() {
    const std::lock_guard lock(mutex_);
    scans_ = 0;
    beams_ = 0;
  }
  const sensor::Sensor& sensor() const { return sensors_.sensors()[0]; }
  uint32_t scans() const { return scans_; }

 private:
  std::mutex mutex_;
  FiredInto target_;
  live::LiveSensors sensors_;
  uint32_t scans_ = 0;
  size_t beams_ = 0;
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
      .def("reset", &Lidar::reset)
      .def_prop_ro("sensor", &Lidar::sensor, nb::rv_policy::reference_internal)
      .def_prop_ro("scans", &Lidar::scans);
}

}  // namespace underbrush::python
