/// \file
/// Facts about logs and their scans.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <sstream>

#include "bind.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::python {
namespace nb = nanobind;
using namespace nb::literals;

void bind_log_info(nb::module_& m) {
  nb::class_<ScanInfo>(
      m, "ScanInfo",
      "A scan (one revolution or frame): its number, its reference time (s) and the\n"
      "sensor's pose at that time.")
      .def(
          "__init__",
          [](ScanInfo* s, uint32_t scan, double time_s, const Pose& pose) {
            new (s) ScanInfo{scan, time_s, pose};
          },
          "scan"_a, "time_s"_a, "world_from_sensor"_a)
      .def_ro("scan", &ScanInfo::scan, "Number of the scan.")
      .def_ro("time_s", &ScanInfo::time_s, "Reference time, s.")
      .def_ro("world_from_sensor", &ScanInfo::world_from_sensor, "Pose at that time.");
  nb::class_<LogInfo>(m, "LogInfo", "Facts about a log as a whole.")
      .def(
          "__init__",
          [](LogInfo* info, const std::string& sensor, double min_range_m, double max_range_m,
             bool has_misses, const std::string& classes, bool deskewed,
             const std::vector<ScanInfo>& scans) {
            new (info) LogInfo{sensor,  "", min_range_m, max_range_m, has_misses,
                               classes, {}, deskewed,    scans};
          },
          nb::kw_only(), "sensor"_a = "", "min_range_m"_a = 0.0, "max_range_m"_a = 120.0,
          "has_misses"_a = false, "classes"_a = "", "deskewed"_a = false,
          "scans"_a = std::vector<ScanInfo>())
      .def_rw("sensor", &LogInfo::sensor, "Name in the sensor catalogue; empty where unknown.")
      .def_rw("sensor_file", &LogInfo::sensor_file,
              "The text of the data file (YAML) of a sensor that is not in the catalogue.")
      .def_rw("min_range_m", &LogInfo::min_range_m, "m; the sensor reports no nearer return.")
      .def_rw("max_range_m", &LogInfo::max_range_m,
              "m; a miss means that there was no return up to this range.")
      .def_rw("has_misses", &LogInfo::has_misses,
              "Whether the log holds beams without a return at all.")
      .def_rw("classes", &LogInfo::classes,
              "Label set that gives the numbers of the column `class` their meaning.")
      .def_rw("element_classes", &LogInfo::element_classes,
              "Names of the numbers of the column `element_class`; empty where they are those of\n"
              "`class_names()` alone.")
      .def_rw("deskewed", &LogInfo::deskewed,
              "Whether each beam carries its own origin along the sensor's motion.")
      .def_prop_rw(
          "scans", [](const LogInfo& i) { return i.scans; },
          [](LogInfo& i, const std::vector<ScanInfo>& s) { i.scans = s; },
          "The scans, in order; reading this makes a list.");
}

}  // namespace underbrush::python
