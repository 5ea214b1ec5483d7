/// \file
/// The verb `simulate`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "fired_into.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/driver_layout.hpp"
#include "underbrush/io/export.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

constexpr size_t kChunk = 1 << 18;  // beams

/// Where a simulated log goes: into memory unless `path` is set.
struct Destination {
  std::optional<std::filesystem::path> path;
  std::string profile, provenance;
};

/// Counts of a simulated log.
struct Counts {
  size_t beams = 0, rows = 0, hits = 0;
};

/// The beams that are simulated: those of a log, or of a sensor on a trajectory.
struct Beams {
  std::optional<GivenLog> like;
  const sensor::Sensor* sensor = nullptr;
  std::optional<Trajectory> trajectory;

  std::unique_ptr<BeamSource> open() {
    if (like) return source_of(*like);
    require(sensor && trajectory && !trajectory->empty(),
            "simulate: give like, or a sensor and a trajectory of at least one pose");
    if (trajectory->poses().size() == 1) {
      trajectory = sensor::one_scan(*sensor, trajectory->poses().front());
    }
    return std::make_unique<sensor::PatternSource>(*sensor, *trajectory,
                                                   trajectory->poses().front().time_s,
                                                   trajectory->poses().back().time_s, kChunk);
  }

  sensor::Sensor sensor_for(const char* what, const BeamSource& source) const {
    if (sensor) return *sensor;
    if (source.info().sensor.empty()) {
      throw std::invalid_argument(std::string("simulate: ") + what +
                                  ", but the log does not name its sensor");
    }
    return sensor::sensor_of_log(name_of(*like), source.info());
  }
};

void write(BeamSource& log, const Destination& to, const Trajectory& path) {
  if (to.profile.empty()) return io::export_log(*to.path, log, "", to.provenance);
  io::export_driver_layout(*to.path, log, io::driver_layout_from_name(to.profile), path,
                           to.provenance);
}

BeamLog collected(BeamSource& log, size_t beams) {
  BeamLog out, chunk;
  while (log.next(chunk)) {
    if (out.empty()) {
      out = chunk.like();
      out.reserve(beams);
    }
    out.append(chunk, 0, chunk.size());
  }
  out.info = log.info();
  return out;
}

std::pair<BeamLog, Counts> simulated(const GivenWorld& model, const SimulateOptions& options,
                                     Beams beams, const Destination& to,
                                     const nb::object& progress) {
  std::pair<BeamLog, Counts> out;
  run_watched(progress, [&](const Hook& hook) {
    const FiredInto target(model, options);
    const std::unique_ptr<BeamSource> fired = beams.open();
    app::Answer answer =
        target.answer(options, [&](const char* what) { return beams.sensor_for(what, *fired); });
    WatchedSource watched(*fired, hook, "simulate");
    simulate::SimulatedSource source(std::ref(answer), watched,
                                     options.answer.simulate.max_range_m);
    source.rewind();
    if (to.path) {
      write(source, to, beams.trajectory.value_or(Trajectory()));
    } else {
      out.first = collected(source, watched.size());
    }
    answer.write_waveforms();
    out.second = {source.beams(), source.rows(), source.hits()};
  });
  return out;
}

// long: the table of options
void bind_options(nb::module_& m) {
  using O = SimulateOptions;
  nb::class_<O> c(m, "SimulateOptions", "The options of `simulate` and `Lidar`.");
  c.def(nb::init<>())
      .def_rw("matter", &O::matter)
      .def_rw("tau", &O::tau)
      .def_rw("grain", &O::grain_m)
      .def_rw("movers", &O::movers);
  const auto text = [&](const char* name, std::string& (*place)(O&)) {
    c.def_prop_rw(
        name, [place](O& o) { return place(o); },
        [place](O& o, const std::string& v) { place(o) = v; });
  };
  const auto number = [&](const char* name, double& (*place)(O&)) {
    c.def_prop_rw(
        name, [place](O& o) { return place(o); }, [place](O& o, double v) { place(o) = v; });
  };
  const auto words = [&](const char* name, std::vector<std::string>& (*place)(O&)) {
    c.def_prop_rw(
        name, [place](O& o) { return place(o); },
        [place](O& o, const std::vector<std::string>& v) { place(o) = v; });
  };
  text(
      "draw", [](O & o) -> auto& { return o.answer.draw; });
  text(
      "beam", [](O & o) -> auto& { return o.answer.beam; });
  text(
      "super_sample", [](O & o) -> auto& { return o.answer.instrument.super_sample; });
  text(
      "returns", [](O & o) -> auto& { return o.answer.instrument.returns; });
  text(
      "materials", [](O & o) -> auto& { return o.answer.instrument.materials; });
  words(
      "material", [](O & o) -> auto& { return o.answer.instrument.material; });
  words(
      "waveforms", [](O & o) -> auto& { return o.answer.instrument.waveforms; });
  number(
      "max_range", [](O & o) -> auto& { return o.answer.simulate.max_range_m; });
  number(
      "range_noise", [](O & o) -> auto& { return o.answer.simulate.range_noise_m; });
  number(
      "wind", [](O & o) -> auto& { return o.answer.simulate.sway_s; });
  text(
      "footprint", [](O & o) -> auto& { return o.answer.instrument.footprint; });
  number(
      "visibility", [](O & o) -> auto& { return o.answer.instrument.visibility_m; });
  number(
      "rain", [](O & o) -> auto& { return o.answer.instrument.rain_mm_per_h; });
  number(
      "sun", [](O & o) -> auto& { return o.answer.instrument.sun; });
  c.def_prop_rw(
       "seed", [](O& o) { return o.answer.simulate.seed; },
       [](O& o, uint64_t v) { o.answer.simulate.seed = v; })
      .def_prop_rw(
          "element_ids", [](O& o) { return o.answer.simulate.element_ids; },
          [](O& o, bool v) { o.answer.simulate.element_ids = v; })
      .def_prop_rw(
          "all_sub_rays", [](O& o) { return o.answer.instrument.all_sub_rays; },
          [](O& o, bool v) { o.answer.instrument.all_sub_rays = v; })
      .def_prop_rw(
          "waveform_every", [](O& o) { return o.answer.instrument.waveform.every; },
          [](O& o, size_t v) {
            require(v > 0, "simulate: waveform_every is positive");
            o.answer.instrument.waveform.every = v;
          })
      .def_prop_rw(
          "waveform_count", [](O& o) { return o.answer.instrument.waveform.count; },
          [](O& o, size_t v) { o.answer.instrument.waveform.count = v; });
}

}  // namespace

void bind_simulate(nb::module_& m) {
  bind_options(m);
  using Like = std::optional<GivenLog>;
  m.def(
      "simulate",
      [](const GivenWorld& model, const SimulateOptions& options, const Like& like,
         const sensor::Sensor* sensor, const std::optional<Trajectory>& trajectory,
         const nb::object& progress) {
        return simulated(model, options, {like, sensor, trajectory}, {}, progress).first;
      },
      "model"_a, "options"_a, "like"_a.none(), "sensor"_a.none(), "trajectory"_a.none(),
      "progress"_a.none(), "Simulates beams into memory.");
  m.def(
      "simulate_to",
      [](const std::filesystem::path& path, const std::string& profile,
         const std::string& provenance, const GivenWorld& model, const SimulateOptions& options,
         const Like& like, const sensor::Sensor* sensor,
         const std::optional<Trajectory>& trajectory, const nb::object& progress) {
        const Counts c = simulated(model, options, {like, sensor, trajectory},
                                   {path, profile, provenance}, progress)
                             .second;
        return std::make_tuple(c.beams, c.rows, c.hits);
      },
      "path"_a, "profile"_a, "provenance"_a, "model"_a, "options"_a, "like"_a.none(),
      "sensor"_a.none(), "trajectory"_a.none(), "progress"_a.none(),
      "Simulates beams into a file; returns the numbers of beams, rows and hits.");
}

}  // namespace underbrush::python
