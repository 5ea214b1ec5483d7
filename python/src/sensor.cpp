/// \file
/// Sensors of the catalogue or of data files.
#include "underbrush/sensor/sensor.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "views.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using sensor::Channel;
using sensor::Sensor;
using SensorSelf = nb::handle_t<Sensor>;

const Sensor& sensor_of(const SensorSelf& s) { return *nb::inst_ptr<Sensor>(s); }

void bind_channels(nb::class_<Sensor>& c) {
  c.def_prop_ro(
       "elevation_rad",
       [](SensorSelf s) {
         return view_member(
             sensor_of(s).channels, [](const Channel& k) { return &k.elevation_rad; }, s);
       },
       "View (channels,) float64, rad, above the sensor's horizontal plane; the index is the ring.")
      .def_prop_ro(
          "azimuth_rad",
          [](SensorSelf s) {
            return view_member(
                sensor_of(s).channels, [](const Channel& k) { return &k.azimuth_rad; }, s);
          },
          "View (channels,) float64, rad, counter-clockwise from the azimuth of the firing.")
      .def_prop_ro(
          "channel_time_s",
          [](SensorSelf s) {
            return view_member(
                sensor_of(s).channels, [](const Channel& k) { return &k.time_s; }, s);
          },
          "View (channels,) float64, s after the start of the firing.");
}

}  // namespace

void bind_sensor(nb::module_& m) {
  nb::class_<Sensor> c(
      m, "Sensor",
      "A lidar: `Sensor(\"velodyne-vlp16\")` from the catalogue, or from the path of a\n"
      "YAML data file. Its frame has x forward, y left, z up. Raises `ValueError`, which\n"
      "names the most similar sensor, and `FormatError` for a malformed file.");
  c.def(
       "__init__", [](Sensor* s, const std::string& name) { new (s) Sensor(sensor::load(name)); },
       "name"_a)
      .def_ro("name", &Sensor::name, "Name in the catalogue.")
      .def_ro("title", &Sensor::title, "Maker and model.")
      .def_prop_ro("kind", &sensor::kind_name,
                   "\"spinning\", \"raster\", \"sweep\", \"directions\" or \"risley\".")
      .def_ro("rate_hz", &Sensor::rate_hz, "Revolutions or frames a second.")
      .def_ro("min_range_m", &Sensor::min_range_m, "m; the sensor reports no nearer return.")
      .def_ro("max_range_m", &Sensor::max_range_m, "m; the sensor reports no farther return.")
      .def_ro("range_sigma_m", &Sensor::range_sigma_m, "m; standard deviation of the range.")
      .def_ro("range_resolution_m", &Sensor::range_resolution_m, "m; step of the reported range.")
      .def_ro("wavelength_m", &Sensor::wavelength_m, "m; wavelength of the light.")
      .def_prop_ro(
          "channels", [](const Sensor& s) { return s.channels.size(); }, "Number of channels.")
      .def_prop_ro("beams_per_s", &Sensor::beams_per_s, "Beams fired in a second.")
      .def("__repr__", [](const Sensor& s) { return "Sensor('" + s.name + "')"; });
  bind_channels(c);
  m.def("sensors", &sensor::names, "Returns the names of the sensor catalogue, sorted.");
  m.def(
      "beams", &sensor::beams, "sensor"_a, "trajectory"_a, "start_s"_a, "end_s"_a,
      nb::call_guard<nb::gil_scoped_release>(),
      "Returns every beam that a sensor fires in [start_s, end_s) along a trajectory, as misses.\n"
      "Raises `ValueError` where the trajectory has no pose for a beam.");
}

}  // namespace underbrush::python
