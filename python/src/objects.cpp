/// \file
/// The verbs `segment`, `extract` and `compose`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "bind.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/extract_primitives.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "watched.hpp"

namespace underbrush::python {
namespace {

using Path = std::filesystem::path;

/// Primitives in memory.
struct PrimitivesValue {
  std::vector<primitives::Primitive> primitives;
  double cell_m = 2;
  std::string report = "{}";
};

/// The labelled log, and what `report_of` reads.
std::pair<BeamLog, std::string> segmented(const GivenLog& log,
                                          const pipeline::SegmentOptions& options,
                                          const nb::object& progress) {
  BeamLog labelled;
  std::string report;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    const pipeline::Segmentation found = pipeline::segment_log(
        *source, options, [&](BeamSource& beams) { labelled = whole_log(beams); }, hook);
    report = pipeline::json_of(found, options, skipped_in(*source)).dump();
  });
  return {std::move(labelled), std::move(report)};
}

PrimitivesValue extracted(const GivenModel& model, const GivenLog& labelled,
                          const pipeline::ExtractOptions& options, const nb::object& progress) {
  PrimitivesValue out;
  out.cell_m = options.cut.measure.cell_m;
  run_watched(progress, [&](const Hook& hook) {
    elements::Model read;
    const elements::Model& from = model_of(model, read);
    const std::unique_ptr<BeamSource> log = source_of(labelled);
    primitives::ExtractResult r = pipeline::extract_primitives(from, name_of(labelled), *log,
                                                               options, of_stage(hook, "extract"));
    out.report = pipeline::json_of(r).dump();
    out.primitives = std::move(r.primitives);
  });
  return out;
}

using GivenSet = std::variant<std::string, const PrimitivesValue*>;

SceneValue composed(const std::string& annotation, const GivenSet& set,
                    const std::optional<GivenModel>& ground,
                    const pipeline::ComposeOptions& options, const std::string& provenance,
                    const nb::object& progress) {
  SceneValue out;
  run_watched(progress, [&](const Hook& hook) {
    pipeline::NamedSet chosen;
    if (const auto* name = std::get_if<std::string>(&set)) {
      chosen = pipeline::primitives_named(*name, options.seed);
    } else {
      const PrimitivesValue& value = *std::get<const PrimitivesValue*>(set);
      chosen = {"primitives", primitives::primitive_set(value.primitives, value.cell_m)};
    }
    elements::Model read;
    pipeline::ComposedScene c = pipeline::compose_scene(annotation, std::move(chosen),
                                                        ground ? &model_of(*ground, read) : nullptr,
                                                        "", options, of_stage(hook, "compose"));
    out.report = pipeline::json_of(c, options).dump();
    out.scene = std::move(c.composition.scene);
    out.info = std::move(c.composition.info);
    out.info.provenance = provenance;
  });
  return out;
}

void bind_primitives(nb::module_& m) {
  using P = PrimitivesValue;
  nb::class_<P>(m, "Primitives", "Objects cut out of a model, each at the identity pose.")
      .def("__len__", [](const P& p) { return p.primitives.size(); })
      .def_prop_ro(
          "labels",
          [](const P& p) {
            std::vector<std::string> out;
            for (const auto& one : p.primitives) out.emplace_back(elements::name(one.label));
            return out;
          },
          "Class of each primitive.")
      .def(
          "copy_model",
          [](const P& p, size_t i) {
            if (i >= p.primitives.size()) throw nb::index_error("primitives: no such primitive");
            return ModelValue{p.primitives[i].model};
          },
          "index"_a, "Returns a copy of a primitive's elements. Raises `IndexError`.")
      .def_prop_ro(
          "report_json", [](const P& p) { return p.report; },
          "What `report_of` reads: counts of the extraction, as JSON.");
  m.def(
      "write_primitives",
      [](const Path& path, const P& p, const std::string& provenance) {
        primitives::write_primitives(path, p.primitives, p.cell_m, provenance);
      },
      "path"_a, "primitives"_a, "provenance"_a, nb::call_guard<nb::gil_scoped_release>(),
      "Writes the folder of a set of primitives. Raises `OSError`.");
}

}  // namespace

void bind_objects(nb::module_& m) {
  bind_options(m, "SegmentOptions", "segment", &pipeline::segment_options);
  m.def("segment", &segmented, "log"_a, "options"_a, "progress"_a.none(),
        "Labels the hits of a log.");
  bind_primitives(m);
  bind_options(m, "ExtractOptions", "extract", &pipeline::extract_options);
  m.def("extract", &extracted, "model"_a, "labelled"_a, "options"_a, "progress"_a.none(),
        "Cuts primitives out of a model along a labelled log.");
  bind_options(m, "ComposeOptions", "compose", &pipeline::compose_options)
      .def_rw("seed", &pipeline::ComposeOptions::seed);
  m.def("compose", &composed, "annotation"_a, "primitives"_a, "ground"_a.none(), "options"_a,
        "provenance"_a, "progress"_a.none(),
        "Composes a scene from primitives along an annotation.");
}

}  // namespace underbrush::python
