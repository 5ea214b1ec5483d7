/// \file
/// A live sensor in a world.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/variant.h>

#include <mutex>

#include "bind.hpp"
#include "fired_into.hpp"
#include "poses.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;
namespace {

/// A sensor that fires one revolution or frame a call.
class Lidar {
 public:
  Lidar(const GivenWorld& world, sensor::Sensor sensor, const SimulateOptions& options)
      : sensor_(std::move(sensor)),
        target_(world, options),
        simulation_(target_.world(), options.pipeline, [this](const char*) { return sensor_; }) {
    require(options.waveforms.empty(), "Lidar: waveforms are of simulate");
  }

  /// Answers the beams of the revolution that starts at `time_s`.
  BeamLog scan(const Pose& from, const Pose& to, double time_s) {
    const std::lock_guard lock(mutex_);
    const double end_s = time_s + 1 / sensor_.rate_hz;
    const Trajectory path({{time_s, from}, {end_s, to}});
    BeamLog out = sensor::beams(sensor_, path, time_s, end_s);
    std::fill(out.scan.begin(), out.scan.end(), scans_);
    for (ScanInfo& s : out.info.scans) s.scan = scans_;
    const double max_range_m = simulation_.options().max_range_m;
    if (max_range_m > 0) out.info.max_range_m = max_range_m;
    const size_t fired = out.size();
    simulation_.answer(beams_, out);
    ++scans_;
    beams_ += fired;
    return out;
  }

  void reset() {
    const std::lock_guard lock(mutex_);
    scans_ = 0;
    beams_ = 0;
  }
  const sensor::Sensor& sensor() const { return sensor_; }
  uint32_t scans() const { return scans_; }

 private:
  std::mutex mutex_;
  sensor::Sensor sensor_;
  FiredInto target_;
  pipeline::Simulation simulation_;
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
