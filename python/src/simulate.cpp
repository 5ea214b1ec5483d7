/// \file
/// The verb `simulate`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "option_table.hpp"
#include "prepared_world.hpp"
#include "report/waveform_outputs.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/driver_layout.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/pipeline/requested_beams.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

/// Where a simulated log goes: into memory unless `path` is set.
struct Destination {
  std::optional<std::filesystem::path> path;
  std::string provenance;
};

/// A request for beams: those of a log, of a sensor or of a rig on a trajectory.
struct Request {
  std::optional<GivenLog> like;
  const sensor::Sensor* sensor = nullptr;
  std::optional<std::filesystem::path> rig;
  std::optional<Trajectory> trajectory;

  pipeline::RequestedBeams beams() const {
    if (like) {
      return {source_of(*like), name_of(*like),
              sensor ? std::optional(*sensor) : std::optional<sensor::Sensor>()};
    }
    require((sensor || rig) && trajectory && !trajectory->empty(),
            "simulate: give like, or a sensor or rig and a trajectory of at least one pose");
    if (rig) return {perception::load_rig(*rig), *trajectory};
    return {*sensor, *trajectory};
  }
};

std::pair<BeamLog, pipeline::SimulateCounts> simulated(const GivenWorld& model,
                                                       SimulateOptions options,
                                                       const Request& request,
                                                       const Destination& to,
                                                       const nb::object& progress) {
  std::pair<BeamLog, pipeline::SimulateCounts> out;
  run_watched(progress, [&](const Hook& hook) {
    const std::string& profile = options.files.profile;
    require(profile.empty() || to.path, "simulate: profile needs output");
    check_options("simulate", report::simulate_files(), options.files);
    report::WaveformOutputs waveforms(options.files.waveforms);
    waveforms.receive_from(options.pipeline);
    options.pipeline.check();
    const PreparedWorld target(model, options);
    const pipeline::RequestedBeams beams = request.beams();
    pipeline::Simulation simulation = beams.simulation(target.world(), options.pipeline);
    WatchedSource source(beams.source(), hook, "simulate");
    if (to.path) {
      out.second = pipeline::simulate_log(simulation, source, [&](BeamSource& log) {
        if (profile.empty()) return io::export_log(*to.path, log, "", to.provenance);
        io::export_driver_layout(*to.path, log, io::driver_layout_from_name(profile), beams.path(),
                                 to.provenance);
      });
    } else {
      out.first = pipeline::simulate_log(simulation, source, {}, &out.second);
    }
    waveforms.write(simulation.sensor());
  });
  for (const std::string& text : out.second.warnings) {
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) < 0) throw nb::python_error();
  }
  return out;
}

void bind_simulate_options(nb::module_& m) {
  using O = SimulateOptions;
  m.def(
      "simulate_options",
      [] {
        return rows_of(pipeline::simulate_options()) + rows_of(report::simulate_files()) +
               rows_of(worlds::read_options());
      },
      nb::sig("def simulate_options() -> list[tuple[str, str, str, str, str]]"),
      "Returns the table of the options of `simulate`: name, type, default, unit and help.");
  nb::class_<O>(m, "SimulateOptions", "The options of `simulate` and `Lidar`.")
      .def(nb::init<>())
      .def(
          "set",
          [](O& o, const std::string& name, nb::handle value) {
            if (has_option(report::simulate_files(), name)) {
              set_option("simulate", report::simulate_files(), o.files, name, value);
            } else if (has_option(worlds::read_options(), name)) {
              set_option("simulate", worlds::read_options(), o.read, name, value);
            } else {
              set_option("simulate", pipeline::simulate_options(), o.pipeline, name, value);
            }
          },
          "name"_a, "value"_a, "Sets a row of the table of options.")
      .def_prop_rw(
          "seed", [](const O& o) { return o.pipeline.seed; },
          [](O& o, uint64_t v) { o.pipeline.seed = v; })
      .def_rw("movers", &O::movers)
      .def_rw("absent", &O::absent);
}

}  // namespace

void bind_simulate(nb::module_& m) {
  bind_simulate_options(m);
  using Like = std::optional<GivenLog>;
  using Rig = std::optional<std::filesystem::path>;
  m.def(
      "simulate",
      [](const GivenWorld& model, const SimulateOptions& options, const Like& like,
         const sensor::Sensor* sensor, const Rig& rig, const std::optional<Trajectory>& trajectory,
         const nb::object& progress) {
        return simulated(model, options, {like, sensor, rig, trajectory}, {}, progress).first;
      },
      "model"_a, "options"_a, "like"_a.none(), "sensor"_a.none(), "rig"_a.none(),
      "trajectory"_a.none(), "progress"_a.none(), "Simulates beams into memory.");
  m.def(
      "simulate_to",
      [](const std::filesystem::path& path, const std::string& provenance, const GivenWorld& model,
         const SimulateOptions& options, const Like& like, const sensor::Sensor* sensor,
         const Rig& rig, const std::optional<Trajectory>& trajectory, const nb::object& progress) {
        const pipeline::SimulateCounts c =
            simulated(model, options, {like, sensor, rig, trajectory}, {path, provenance}, progress)
                .second;
        return std::make_tuple(c.beams, c.rows, c.hits);
      },
      "path"_a, "provenance"_a, "model"_a, "options"_a, "like"_a.none(), "sensor"_a.none(),
      "rig"_a.none(), "trajectory"_a.none(), "progress"_a.none(),
      "Simulates beams into a file; returns the numbers of beams, rows and hits.");
}

}  // namespace underbrush::python
