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
#include "underbrush/core/check.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/optimize/options.hpp"
#include "underbrush/pipeline/kept_search.hpp"
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

using Files = std::vector<std::filesystem::path>;

/// Adds the hashes of what a search reads to its file.
pipeline::SearchFile with_inputs(pipeline::SearchFile file, const GivenLog& log,
                                 const Files& others) {
  const auto* path = std::get_if<std::filesystem::path>(&log);
  require(path, "optimize: a checkpoint needs a log that is in a file");
  file.inputs.push_back(io::hash_of(*path));
  for (const auto& other : others) file.inputs.push_back(io::hash_of(other));
  return file;
}

TuningValue searched(const GivenLog& log, const TuneOptions& o, bool densities,
                     pipeline::TuningProblem problem, const pipeline::SearchFile& file,
                     const Hook& hook) {
  TuningValue out;
  out.log = name_of(log);
  out.objective = o.objective;
  out.what = report::sentence_on(problem.slice, o.cut(), densities);
  out.densities = densities;
  out.parameters = problem.parameters;
  size_t done = 0;
  problem.objective = [&hook, &o, &done,
                       judge = std::move(problem.objective)](std::span<const double> value) {
    hook("optimize", done, o.search.budget);
    return judge(value);
  };
  const auto after = [&](std::span<const Evaluation> so_far) {
    done = so_far.size();
    hook("optimize", done, o.search.budget);
  };
  try {
    if (file.path.empty()) {
      out.evaluations = pipeline::tune(problem, o, {}, after);
    } else {
      const pipeline::SearchFile whole = with_inputs(file, log, problem.inputs);
      out.evaluations = pipeline::tune_and_keep(problem, o, whole, after).evaluations;
      pipeline::end_search(whole);
    }
  } catch (const DataError& e) {
    if (!std::holds_alternative<std::filesystem::path>(log)) throw;
    throw FormatError(name_of(log), "", e.what());
  }
  return out;
}

TuningValue tuned_fit(const GivenLog& log, const TuneOptions& o, const nb::dict& parameters,
                      const sensor::Sensor* sensor, const pipeline::SearchFile& file,
                      const nb::object& progress) {
  fit::FitOptions options;
  set_fit_options(options, parameters, o.seed, sensor);
  TuningValue out;
  run_watched(progress, [&](const Hook& hook) {
    out =
        searched(log, o, false, pipeline::tuned_fit(*source_of(log, true), o, options), file, hook);
  });
  return out;
}

TuningValue tuned_scene(const GivenLog& log, const TuneOptions& o,
                        const std::filesystem::path& annotation, const std::string& primitives,
                        bool allow_outside, const pipeline::SearchFile& file,
                        const nb::object& progress) {
  TuningValue out;
  run_watched(progress, [&](const Hook& hook) {
    pipeline::SceneParts parts =
        pipeline::read_scene_parts(annotation, primitives, allow_outside, o.seed);
    out = searched(log, o, true, pipeline::tuned_scene(*source_of(log, true), o, std::move(parts)),
                   file, hook);
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
  using File = pipeline::SearchFile;
  nb::class_<File>(m, "SearchFile", "The file in which a search keeps its evaluations.")
      .def(
          "__init__",
          [](File* f, const std::filesystem::path& path, bool resume, const std::string& program,
             const std::string& fixed) {
            new (f) File{path, resume, program, {}, fixed};
          },
          "path"_a, "resume"_a, "program"_a, "fixed"_a);
  m.def("optimize_fit", &tuned_fit, "log"_a, "options"_a, "parameters"_a, "sensor"_a.none(),
        "file"_a, "progress"_a.none(), "Tunes parameters of a fit.");
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
        "allow_outside"_a, "file"_a, "progress"_a.none(),
        "Tunes the class densities of a composed scene.");
}

}  // namespace underbrush::python
