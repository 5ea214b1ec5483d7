/// \file
/// The verbs `segment`, `extract` and `compose`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "bind.hpp"
#include "composition.hpp"
#include "given.hpp"
#include "labelled_log.hpp"
#include "objects_of_log.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/primitives/extract.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using Path = std::filesystem::path;
using primitives::ComposeOptions;
using primitives::ExtractOptions;
using primitives::SegmentLogOptions;

/// Primitives in memory.
struct PrimitivesValue {
  std::vector<primitives::Primitive> primitives;
  double cell_m = 2;
  std::string report = "{}";
};

std::pair<BeamLog, std::string> segmented(const GivenLog& log, const SegmentLogOptions& options,
                                          const std::optional<Path>& labels, const std::string& set,
                                          const std::string& truth, const nb::object& progress) {
  std::pair<BeamLog, std::string> out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    std::optional<primitives::GivenLabels> given;
    std::optional<primitives::LogLabels> found;
    if (labels) {
      primitives::GivenLabelOptions o;
      o.set = set;
      given = primitives::read_given_labels(*labels, *source, o);
    }
    const bool whole =
        given && given->set == "underbrush" && !given->label.empty() && !given->instance.empty();
    if (!whole) {
      found =
          primitives::segment_log(*source, options,
                                  given && !given->label.empty() ? app::priors_of(*given)
                                                                 : std::vector<primitives::Prior>{},
                                  hook);
    }
    const app::LabelsOfHits hits =
        given ? app::taken_over(*given, found ? &*found : nullptr) : app::found_of(*found);
    source->rewind();
    app::LabelledSource labelled(*source, hits, app::LabelledCounts(truth, !labels));
    BeamLog& whole_log = out.first;
    for (BeamLog chunk; labelled.next(chunk);) {
      if (whole_log.empty()) {
        whole_log = chunk.like();
        whole_log.reserve(source->size());
      }
      whole_log.append(chunk, 0, chunk.size());
    }
    whole_log.info = labelled.info();
    app::Json report = app::json_of(labelled.counts());
    report["objects"] = hits.objects;
    report["skipped"] = skipped_in(*source);
    if (found) report["cell_m"] = found->cell_m;
    if (found) report["off_ground"] = found->off_ground;
    if (found) report["near"] = found->near;
    if (given)
      report["labels"] = {
          {"set", given->set}, {"by_place", given->by_place}, {"unmatched", given->unmatched}};
    out.second = report.dump();
  });
  return out;
}

PrimitivesValue extracted(const GivenModel& model, const GivenLog& labelled,
                          const ExtractOptions& options, const nb::object& progress) {
  PrimitivesValue out;
  out.cell_m = options.measure.cell_m;
  run_watched(progress, [&](const Hook& hook) {
    elements::Model read;
    const elements::Model& from = model_of(model, read);
    const std::unique_ptr<BeamSource> log = source_of(labelled);
    app::require_objects(name_of(labelled), *log);
    require_data(from.ground.size() > 0, "extract: the model has no ground");
    primitives::ExtractResult r = primitives::extract(
        from, *log, options, [&](size_t done, size_t total) { hook("extract", done, total); });
    require_data(!r.primitives.empty(),
                 "extract: none of the log's objects holds an element of the model");
    app::Json report = app::json_of(r.measured);
    report["primitives"] = r.primitives.size();
    report["elements"] = r.elements;
    report["elements_taken"] = r.taken;
    report["free_space"] = r.free_space;
    report["empty"] = r.empty;
    report["few_elements"] = r.few_elements;
    out.report = report.dump();
    out.primitives = std::move(r.primitives);
  });
  return out;
}

using GivenSet = std::variant<std::string, const PrimitivesValue*>;

SceneValue composed(const Path& annotation, const GivenSet& set,
                    const std::optional<GivenModel>& ground, const ComposeOptions& options,
                    bool allow_outside, const std::string& provenance, const nb::object& progress) {
  SceneValue out;
  run_watched(progress, [&](const Hook& hook) {
    const primitives::Annotation site = primitives::read_annotation(annotation, allow_outside);
    primitives::PrimitiveSet chosen;
    if (const auto* name = std::get_if<std::string>(&set)) {
      chosen = app::primitives_named(*name, options.seed).set;
    } else {
      const PrimitivesValue& value = *std::get<const PrimitivesValue*>(set);
      chosen = primitives::primitive_set(value.primitives, value.cell_m);
    }
    elements::Model read;
    const elements::Model& on = ground ? model_of(*ground, read) : read;
    if (!ground) read = elements::read_model(site.ground.lexically_normal());
    require_data(on.ground.size() > 0, "compose: the model has no ground");
    primitives::Composition c =
        primitives::compose(site, on, chosen, options,
                            [&](size_t done, size_t total) { hook("compose", done, total); });
    out.report = app::json_of(c).dump();
    out.scene = std::move(c.scene);
    out.info = std::move(c.info);
    out.info.provenance = provenance;
  });
  return out;
}

void bind_segment(nb::module_& m) {
  using S = SegmentLogOptions;
  nb::class_<S> c(m, "SegmentOptions", "The options of `segment`.");
  c.def(nb::init<>()).def_rw("tile", &S::tile_m).def_rw("min_range", &S::min_range_m);
  const auto number = [&](const char* name, double& (*place)(S&)) {
    c.def_prop_rw(
        name, [place](S& o) { return place(o); }, [place](S& o, double v) { place(o) = v; });
  };
  number(
      "cell", [](S & o) -> auto& { return o.objects.cell_m; });
  number(
      "gap", [](S & o) -> auto& { return o.objects.gap_m; });
  number(
      "spacing", [](S & o) -> auto& { return o.objects.spacing_a_m; });
  number(
      "prominence", [](S & o) -> auto& { return o.objects.prominence_a_m; });
  number(
      "radius", [](S & o) -> auto& { return o.objects.radius_a_m; });
  number(
      "foot", [](S & o) -> auto& { return o.objects.trunk_m; });
  number(
      "tree_height", [](S & o) -> auto& { return o.objects.sizes.tree_m; });
  number(
      "small_shrub_height", [](S & o) -> auto& { return o.objects.sizes.small_shrub_m; });
  number(
      "medium_tree_height", [](S & o) -> auto& { return o.objects.sizes.medium_tree_m; });
  number(
      "large_tree_height", [](S & o) -> auto& { return o.objects.sizes.large_tree_m; });
  number(
      "patch_side", [](S & o) -> auto& { return o.objects.sizes.patch_m; });
  c.def_prop_rw(
       "ground_method", [](S& o) { return o.ground.method; },
       [](S& o, const std::string& v) { o.ground.method = v; })
      .def_prop_rw(
          "min_points", [](S& o) { return o.objects.min_points; },
          [](S& o, size_t v) { o.objects.min_points = v; });
  m.def("segment", &segmented, "log"_a, "options"_a, "labels"_a.none(), "label_set"_a, "truth"_a,
        "progress"_a.none(), "Labels the hits of a log.");
}

void bind_extract(nb::module_& m) {
  using E = ExtractOptions;
  nb::class_<E>(m, "ExtractOptions", "The options of `extract`.")
      .def(nb::init<>())
      .def_rw("free_space_below", &E::free_space_below)
      .def_rw("min_elements", &E::min_elements)
      .def_prop_rw(
          "box_quantile", [](E& o) { return o.measure.quantile; },
          [](E& o, double v) { o.measure.quantile = v; })
      .def_prop_rw(
          "patch_cell", [](E& o) { return o.measure.cell_m; },
          [](E& o, double v) { o.measure.cell_m = v; })
      .def_prop_rw(
          "min_points", [](E& o) { return o.measure.min_points; },
          [](E& o, size_t v) { o.measure.min_points = v; })
      .def_prop_rw(
          "elements",
          [](E& o) { return o.membership == primitives::Membership::kBox ? "box" : "own"; },
          [](E& o, const std::string& v) {
            require(v == "own" || v == "box", "extract: elements is own or box");
            o.membership = v == "box" ? primitives::Membership::kBox : primitives::Membership::kOwn;
          });
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
  m.def("extract", &extracted, "model"_a, "labelled"_a, "options"_a, "progress"_a.none(),
        "Cuts primitives out of a model along a labelled log.");
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
  bind_segment(m);
  bind_extract(m);
  using C = ComposeOptions;
  nb::class_<C>(m, "ComposeOptions", "The options of `compose`.")
      .def(nb::init<>())
      .def_rw("seed", &C::seed)
      .def_rw("nearest", &C::nearest)
      .def_rw("scale", &C::scale)
      .def(
          "set_density",
          [](C& o, const std::string& name, double factor) {
            const auto label = elements::class_from_name(name);
            if (!label) throw std::invalid_argument("compose: no class '" + name + "'");
            require(factor >= 0 && factor <= 100, "compose: a density is in [0, 100]");
            o.density[*label] = factor;
          },
          "name"_a, "factor"_a);
  m.def("compose", &composed, "annotation"_a, "primitives"_a, "ground"_a.none(), "options"_a,
        "allow_outside"_a, "provenance"_a, "progress"_a.none(),
        "Composes a scene from primitives along an annotation.");
}

}  // namespace underbrush::python
