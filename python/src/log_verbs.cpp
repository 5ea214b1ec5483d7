/// \file
/// The verbs `import`, `split` and `perceive`.
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "bind.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "underbrush/core/range_unit.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/list_file.hpp"
#include "underbrush/pipeline/beam_checks.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "underbrush/pipeline/sensor_checks.hpp"
#include "underbrush/pipeline/split_log.hpp"
#include "watched.hpp"

namespace underbrush::python {
namespace {

using Path = std::filesystem::path;

std::pair<BeamLog, std::string> imported(const Path& source, const pipeline::ImportOptions& options,
                                         const std::optional<Path>& output,
                                         const std::string& provenance,
                                         const nb::object& progress) {
  std::pair<BeamLog, std::string> out;
  run_watched(progress, [&](const Hook& hook) {
    LogInfo info;
    std::vector<BeamLog> chunks;
    std::optional<io::LogWriter> writer;
    const pipeline::ImportReport report = pipeline::import_log(
        source, options,
        [&](const LogInfo& known) {
          info = known;
          if (output) {
            writer.emplace(*output, info, provenance,
                           io::LogWriterOptions{!options.float_coordinates});
          }
        },
        [&](const BeamLog& beams) {
          if (writer) writer->write(beams);
          chunks.push_back(beams);
        },
        of_stage(hook, "import"));
    if (writer) writer->close();
    BeamLog& whole = out.first;
    whole = joined(std::move(chunks));
    whole.info = info;
    whole.info.has_misses |= report.beam.misses_recorded + report.beam.misses_inferred > 0;
    out.second = pipeline::json_of(report).dump();
  });
  return out;
}

std::pair<BeamLog, BeamLog> split(const GivenLog& log, const pipeline::SplitOptions& options,
                                  const nb::object& progress) {
  std::pair<BeamLog, BeamLog> out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    std::vector<BeamLog> train_chunks, test_chunks;
    with_name(log, [&] {
      return pipeline::split_log(
          *source, options,
          [&](const BeamLog& train, const BeamLog& test) {
            train_chunks.push_back(train);
            test_chunks.push_back(test);
          },
          of_stage(hook, "split"));
    });
    out = {joined(std::move(train_chunks)), joined(std::move(test_chunks))};
    out.first.info = out.second.info = source->info();
  });
  return out;
}

/// Lists of objects in memory, a list a cycle, with those of the truth.
struct PerceivedValue {
  std::vector<perception::ObjectList> lists, truth;
  std::string report;
};

PerceivedValue perceived(const GivenLog& log, const perception::PerceiveOptions& options,
                         const std::optional<Path>& grid, const std::string& provenance,
                         const nb::object& progress) {
  PerceivedValue out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> given = source_of(log, true);
    WatchedSource source(*given, hook, "perceive");
    std::optional<perception::LogTruth> truth;
    if (!options.truth.empty()) {
      truth = osi::truth_of_log(options.truth, source.info(),
                                {options.truth_elevation_deg * M_PI / 180});
    }
    const pipeline::GridFile file{grid.value_or(""), provenance};
    with_name(log, [&] {
      pipeline::Perceived found = pipeline::perceive_log(source, truth ? &*truth : nullptr, options,
                                                         grid ? &file : nullptr);
      out.report = pipeline::json_of(found).dump();
      out.lists = std::move(found.log.lists);
      out.truth = std::move(found.log.truth);
    });
  });
  return out;
}

/// The objects of a list as dicts.
nb::list objects_of(const PerceivedValue& v, size_t cycle) {
  if (cycle >= v.lists.size()) throw nb::index_error("perceive: no such cycle");
  nb::list out;
  for (const perception::TrackedObject& o : v.lists[cycle].objects) {
    nb::dict d;
    const auto name = perception::name(o.label);
    const auto triple = [](const Vec3& p) { return nb::make_tuple(p.x(), p.y(), p.z()); };
    d["id"] = o.id;
    d["class"] = nb::str(name.data(), name.size());
    d["existence"] = o.existence;
    d["centre_m"] = triple(o.box.centre_m);
    d["size_m"] = triple(o.box.size_m);
    d["yaw_rad"] = o.box.yaw_rad;
    d["velocity_m_s"] = triple(o.velocity_m_s);
    out.append(d);
  }
  return out;
}

void bind_perceive(nb::module_& m) {
  using V = PerceivedValue;
  nb::class_<V>(m, "ObjectLists", "Lists of tracked objects in the world's frame, a list a cycle.")
      .def("__len__", [](const V& v) { return v.lists.size(); })
      .def(
          "time_s",
          [](const V& v, size_t cycle) {
            if (cycle >= v.lists.size()) throw nb::index_error("perceive: no such cycle");
            return v.lists[cycle].time_s;
          },
          "cycle"_a, "Returns the time (s) of a cycle. Raises `IndexError`.")
      .def("objects", &objects_of, "cycle"_a,
           nb::sig("def objects(self, cycle: int) -> list[dict[str, typing.Any]]"),
           "Returns the objects of a cycle as dicts of id, class, existence, centre_m, size_m\n"
           "(length, width, height), yaw_rad and velocity_m_s. Raises `IndexError`.")
      .def_prop_ro(
          "report_json", [](const V& v) { return v.report; },
          "What `report_of` reads: counts, scores and areas, as JSON.");
  bind_options(m, "PerceiveOptions", "perceive", &perception::perceive_options)
      .def_prop_rw(
          "seed", [](const perception::PerceiveOptions& o) { return o.setup.seed; },
          [](perception::PerceiveOptions& o, uint64_t v) { o.setup.seed = v; });
  m.def("perceive", &perceived, "log"_a, "options"_a, "grid"_a.none(), "provenance"_a,
        "progress"_a.none(), "Turns a log into lists of tracked objects.");
  m.def(
      "write_objects",
      [](const Path& path, const V& v, bool truth, const std::string& provenance) {
        osi::write_lists(path, truth ? v.truth : v.lists, provenance);
      },
      "path"_a, "lists"_a, "truth"_a = false, "provenance"_a = "",
      nb::call_guard<nb::gil_scoped_release>(),
      "Writes lists of objects, or their truth, as .csv, .json or .osi, by the extension. Raises\n"
      "`ValueError`, `OSError`.");
}

using Points = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Rings = nb::ndarray<const uint16_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void check_sensor(const std::string& source, const sensor::Sensor& known, const Points& point,
                  const std::optional<Rings>& ring) {
  PointScan scan;
  for (size_t i = 0; i < point.shape(0); ++i) {
    scan.point.emplace_back(point(i, 0), point(i, 1), point(i, 2));
  }
  if (ring) scan.ring.assign(ring->data(), ring->data() + ring->shape(0));
  pipeline::check_sensor_of(source, "--sensor", scan, known);
}

}  // namespace

void bind_log_verbs(nb::module_& m) {
  bind_options(m, "ImportOptions", "import", &pipeline::import_options);
  m.def(
      "import_log", &imported, "source"_a, "options"_a, "output"_a.none(), "provenance"_a,
      "progress"_a.none(),
      "Reads a log of any supported format into memory, and writes it to `output` as it is read.");
  nb::class_<pipeline::BeamChecks>(m, "BeamChecks", "Checks of ranges and poses of a log's beams.")
      .def(nb::init<>())
      .def("add", &pipeline::BeamChecks::add, "beams"_a, "Takes the next beams of a log.")
      .def("warnings", &pipeline::BeamChecks::warnings, nb::call_guard<nb::gil_scoped_release>(),
           "Returns what does not fit in the first scans, each with its likely cause.");
  m.def(
      "check_sensor", &check_sensor, "source"_a, "sensor"_a, "point"_a, "ring"_a.none(),
      "Raises `FormatError` where a scan cannot come from a sensor by its rings, elevations and\n"
      "ranges: points (n, 3) m in the sensor's frame, and their rings (n,) where they are known.");
  nb::class_<RangeUnit>(m, "RangeUnit", "Whether the ranges of a log are in metres.")
      .def(nb::init<>())
      .def("add", &RangeUnit::add, "beams"_a,
           "Takes the next beams of a log. Returns whether more are wanted.")
      .def("warning", &RangeUnit::warning, "Returns what is wrong with the log, or nothing.");
  bind_options(m, "SplitOptions", "split", &pipeline::split_options);
  m.def("split", &split, "log"_a, "options"_a, "progress"_a.none(),
        "Splits a log into a part for training and one for tests.");
  bind_perceive(m);
}

}  // namespace underbrush::python
