/// \file
/// Logs in memory, whose columns Python sees as arrays.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrow_tables.hpp"
#include "bind.hpp"
#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/check.hpp"
#include "views.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using Self = nb::handle_t<BeamLog>;

BeamLog& log_of(const Self& self) { return *nb::inst_ptr<BeamLog>(self); }

/// Names of the named columns.
constexpr const char* kNamed[] = {"origin", "direction", "range_m", "intensity", "time_s",
                                  "ring",   "scan",      "packet",  "flags"};

nb::object view_of(ExtraColumn& column, nb::handle owner) {
  return std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        return nb::cast(view<T>(values, owner));
      },
      column);
}

nb::dict extra_of(const Self& self) {
  nb::dict out;
  for (auto& [name, column] : log_of(self).extra) out[name.c_str()] = view_of(column, self);
  return out;
}

ExtraColumn column_of_type(const std::string& type, size_t n) {
  if (type == "uint8" || type == "bool") return std::vector<uint8_t>(n);
  if (type == "uint16") return std::vector<uint16_t>(n);
  if (type == "uint32") return std::vector<uint32_t>(n);
  if (type == "int8") return std::vector<int8_t>(n);
  if (type == "int16") return std::vector<int16_t>(n);
  if (type == "int32") return std::vector<int32_t>(n);
  if (type == "float32") return std::vector<float>(n);
  if (type == "float64") return std::vector<double>(n);
  throw std::invalid_argument("log: a column of type " + type +
                              "; a log holds int8 to int32, uint8 to uint32, float32 and float64");
}

nb::object add_column(const Self& self, const std::string& name, nb::handle dtype) {
  BeamLog& log = log_of(self);
  require(!log.extra.contains(name), "log: there is a column of this name");
  for (const char* named : kNamed) require(name != named, "log: there is a column of this name");
  const nb::object type = nb::module_::import_("numpy").attr("dtype")(dtype).attr("name");
  log.extra.emplace(name, column_of_type(nb::cast<std::string>(type), log.size()));
  return view_of(log.extra.at(name), self);
}

Rows<double, 3> end_points(const BeamLog& log) {
  double* at = nullptr;
  Rows<double, 3> out = new_rows<3>(log.size(), at);
  const nb::gil_scoped_release released;
  for (size_t i = 0; i < log.size(); ++i, at += 3) Eigen::Map<Vec3>{at} = log.end_point(i);
  return out;
}

void bind_columns(nb::class_<BeamLog>& c) {
  c.def_prop_ro(
       "origin", [](Self s) { return view_rows<double, 3>(log_of(s).origin, s); },
       "View (n, 3) float64, m, world: where each beam starts.")
      .def_prop_ro(
          "direction", [](Self s) { return view_rows<float, 3>(log_of(s).direction, s); },
          "View (n, 3) float32, world: unit vectors.")
      .def_prop_ro(
          "range_m", [](Self s) { return view<float>(log_of(s).range_m, s); },
          "View (n,) float32, m; infinity where there was no return.")
      .def_prop_ro(
          "intensity", [](Self s) { return view<float>(log_of(s).intensity, s); },
          "View (n,) float32 in the sensor's unit; 0 for a miss.")
      .def_prop_ro(
          "time_s", [](Self s) { return view<double>(log_of(s).time_s, s); },
          "View (n,) float64, s.")
      .def_prop_ro(
          "ring", [](Self s) { return view<uint16_t>(log_of(s).ring, s); },
          "View (n,) uint16: channel, in the order of the sensor's catalogue entry.")
      .def_prop_ro(
          "scan", [](Self s) { return view<uint32_t>(log_of(s).scan, s); },
          "View (n,) uint32: number of the revolution or frame.")
      .def_prop_ro(
          "packet", [](Self s) { return view<uint32_t>(log_of(s).packet, s); },
          "View (n,) uint32: beams of a scan with equal numbers share a sensor pose.")
      .def_prop_ro(
          "flags", [](Self s) { return view<uint8_t>(log_of(s).flags, s); },
          "View (n,) uint8; bit 0: the miss was inferred from the scan pattern.")
      .def_prop_ro("extra", &extra_of,
                   nb::sig("def extra(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
                   "Views (n,) of the further columns by name, such as `class` or `echo`.");
}

}  // namespace

void bind_log(nb::module_& m) {
  nb::class_<BeamLog> c(
      m, "BeamLog",
      "Beams in columns, in firing order, misses included.\n\n"
      "The columns are views of the log's memory: nothing is copied, writing into them changes "
      "the\n"
      "log, and each keeps the log alive. A log has a fixed length; `BeamLog(n)` has n misses at\n"
      "the origin along +x, to be filled through the views. Libraries that read Arrow's tables "
      "take a\n"
      "log for one, such as `pyarrow.table(log)`, and share its memory.");
  c.def(
       "__init__",
       [](BeamLog* log, size_t n, const std::optional<LogInfo>& info) {
         new (log) BeamLog();
         if (info) log->info = *info;
         log->resize(n);
       },
       "n"_a = 0, "info"_a = nb::none())
      .def("__len__", &BeamLog::size)
      .def_rw("info", &BeamLog::info, "Facts about the log as a whole.")
      .def(
          "add_column", &add_column, "name"_a, "dtype"_a,
          nb::sig("def add_column(self, name: str, dtype: numpy.typing.DTypeLike) -> "
                  "numpy.typing.NDArray[typing.Any]"),
          "Adds a column of zeros and returns its view. `dtype` is one of int8 to int32, uint8 to\n"
          "uint32, float32 and float64. Raises `ValueError` where the name is taken.")
      .def("end_points", &end_points,
           "Returns a new array (n, 3) float64, m, world: the end point of each hit, and for a "
           "miss\n"
           "the point at the log's maximum range.")
      .def(
          "copy", [](const BeamLog& log) { return BeamLog(log); },
          "Returns a copy with memory of its own.")
      .def(
          "slice",
          [](const BeamLog& log, size_t begin, size_t end) {
            BeamLog out = log.like();
            out.append(log, begin, end);
            return out;
          },
          "begin"_a, "end"_a, nb::call_guard<nb::gil_scoped_release>(),
          "Returns a copy of the rows [begin, end). Raises `ValueError` outside the log.")
      .def("__repr__", [](const BeamLog& log) {
        return "BeamLog(" + std::to_string(log.size()) + " rows" +
               (log.info.sensor.empty() ? "" : ", " + log.info.sensor) + ")";
      });
  bind_columns(c);
  bind_arrow(c, [](const Self& self) { return table_of(log_of(self), kept_alive(self)); });
}

}  // namespace underbrush::python
