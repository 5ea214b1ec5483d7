/// \file
/// The verb `optimize`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "bind.hpp"
#include "fit_parameters.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "report/tuning.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/optimize/fit_parameters.hpp"
#include "underbrush/optimize/options.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
#include "underbrush/pipeline/tune.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using optimize::Evaluation;
using optimize::TuneOptions;
using Values = std::map<std::string, double>;

/// A search that has ended.
struct TuningValue : report::Tuning {
  Values values_of(const Evaluation& e) const {
    Values out;
    for (size_t k = 0; k < parameters.size(); ++k) out[parameters[k].name] = e.value[k];
    return out;
  }
};

TuningValue searched(const GivenLog& log, const TuneOptions& o, std::string what,
                     pipeline::TuningProblem problem, const Hook& hook) {
  TuningValue out;
  out.log = name_of(log);
  out.objective = o.objective;
  out.what = std::move(what);
  out.parameters = std::move(problem.parameters);
  const auto judged = [&](std::span<const double> value) {
    hook("optimize", out.evaluations.size(), o.search.budget);
    return problem.objective(value);
  };
  try {
    out.evaluations = optimize::search(out.parameters, problem.start, o.search, judged, {},
                                       [&](std::span<const Evaluation> so_far) {
                                         hook("optimize", so_far.size(), o.search.budget);
                                       });
  } catch (const DataError& e) {
    if (!std::holds_alternative<std::filesystem::path>(log)) throw;
    throw FormatError(name_of(log), "", e.what());
  }
  return out;
}

TuningValue tuned_fit(const GivenLog& log, const TuneOptions& o, const nb::dict& parameters,
                      const sensor::Sensor* sensor, const nb::object& progress) {
  fit::FitOptions options;
  set_fit_options(options, parameters, o.seed, sensor);
  const optimize::SliceOptions cut = o.cut();
  optimize::chosen_fit_parameters(options, o.tune);  // This throws for unknown names.
  TuningValue out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    const auto slice = std::make_shared<const optimize::Slice>(optimize::take_slice(*source, cut));
    out = searched(log, o, report::sentence_on(*slice, cut, false),
                   pipeline::tuned_fit(o.objective, slice, options, o.tune), hook);
  });
  return out;
}

TuningValue tuned_scene(const GivenLog& log, const TuneOptions& o,
                        const std::filesystem::path& annotation, const std::string& primitives,
                        bool allow_outside, const nb::object& progress) {
  const optimize::SliceOptions cut = o.cut();
  TuningValue out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    optimize::Slice slice = optimize::take_slice(*source, cut);
    const auto parts = std::make_shared<pipeline::SceneParts>();
    parts->annotation = primitives::read_annotation(annotation, allow_outside);
    parts->ground = elements::read_model(parts->annotation.ground.lexically_normal());
    parts->primitives = pipeline::primitives_named(primitives, o.seed).set;
    std::string what = report::sentence_on(slice, cut, true);
    BeamLog beams = std::move(slice.fit);
    beams.append(slice.validation, 0, slice.validation.size());
    out =
        searched(log, o, std::move(what),
                 pipeline::tuned_scene(o.objective, parts, std::move(beams), o.seed, o.tune), hook);
    out.densities = true;
  });
  return out;
}

}  // namespace

void bind_optimize(nb::module_& m) {
  bind_options<TuneOptions>(m, "TuneOptions", "optimize", &optimize::tune_options)
      .def_rw("seed", &TuneOptions::seed);
  using V = TuningValue;
  nb::class_<V>(m, "Tuning", "A search for parameters that has ended.")
      .def(
          "__len__", [](const V& v) { return v.evaluations.size(); }, "Number of evaluations.")
      .def_prop_ro(
          "parameters", [](const V& v) { return v.values_of(v.tuned()); },
          "The best values by name, for `fit(log, **parameters)` once `-` is `_`.")
      .def_prop_ro(
          "start", [](const V& v) { return v.values_of(v.Tuning::start()); },
          "The values at the start.")
      .def_prop_ro(
          "objective", [](const V& v) { return v.tuned().outcome.objective; },
          "The lowest objective.")
      .def_prop_ro(
          "start_objective", [](const V& v) { return v.start().outcome.objective; },
          "The objective at the start.")
      .def_prop_ro(
          "scores", [](const V& v) { return v.tuned().outcome.score; },
          "Scores of the best values.")
      .def_prop_ro(
          "history",
          [](const V& v) {
            std::vector<std::pair<Values, double>> out;
            for (const Evaluation& e : v.evaluations)
              out.emplace_back(v.values_of(e), e.outcome.objective);
            return out;
          },
          "All values that were tried, in order, with their objectives.");
  m.def("optimize_fit", &tuned_fit, "log"_a, "options"_a, "parameters"_a, "sensor"_a.none(),
        "progress"_a.none(), "Tunes parameters of a fit.");
  m.def(
      "write_tuning_report",
      [](const std::filesystem::path& folder, V tuning, const std::string& fixed,
         const std::string& provenance) {
        tuning.fixed = nlohmann::ordered_json::parse(fixed);
        tuning.provenance = provenance;
        return report::write_tuning_report(folder, tuning);
      },
      "folder"_a, "tuning"_a, "fixed"_a, "provenance"_a, nb::call_guard<nb::gil_scoped_release>(),
      "Writes the page of a search and returns its path.");
  m.def("optimize_scene", &tuned_scene, "log"_a, "options"_a, "annotation"_a, "primitives"_a,
        "allow_outside"_a, "progress"_a.none(), "Tunes the class densities of a composed scene.");
}

}  // namespace underbrush::python
