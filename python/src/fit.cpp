/// \file
/// The verb `fit`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "bind.hpp"
#include "fit_parameters.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "underbrush/io/hash.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/log_sequence.hpp"
#include "underbrush/pipeline/fit_json.inl"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

/// Adds the hashes of inputs to the provenance that Python gives.
pipeline::Provenance with_hashes(const std::string& text) {
  return [text](const std::vector<std::filesystem::path>& inputs) {
    nlohmann::ordered_json j = io::json_of_text(text);
    for (const auto& input : inputs) j["inputs"][input.string()] = io::hash_of(input);
    return io::text_of_json(j);
  };
}

using Files = std::vector<std::filesystem::path>;

Files files_of(const GivenLog& log) {
  const auto* path = std::get_if<std::filesystem::path>(&log);
  return path ? Files{*path} : Files();
}

template <class Trained>
ModelValue value_of(Trained trained, const BeamSource& log) {
  ModelValue out;
  out.report = json_of(trained, skipped_in(log)).dump();
  static_cast<elements::Model&>(out) = std::move(trained.model);
  out.training = std::move(trained.training);
  return out;
}

/// Fits a model to a log, or to the files of several.
ModelValue fitted(const std::variant<GivenLog, Files>& logs, const nb::dict& parameters,
                  uint64_t seed, const sensor::Sensor* sensor, const update::FitLogOptions& of_log,
                  const std::string& provenance, const nb::object& progress) {
  fit::FitOptions options;
  set_fit_options(options, parameters, seed, sensor);
  of_log.check(false);
  if (of_log.echoes == "all") fit::take_all_echoes(options, parameters.contains("keyframes"));
  ModelValue out;
  run_watched(progress, [&](const Hook& hook) {
    const auto* log = std::get_if<GivenLog>(&logs);
    const Files files = log ? files_of(*log) : std::get<Files>(logs);
    const std::unique_ptr<BeamSource> beams =
        log ? source_of(*log, true) : std::make_unique<io::LogSequence>(files);
    WatchedSource source(*beams, hook, "fit");
    out = value_of(pipeline::fit_model({source, files}, options, with_hashes(provenance), hook),
                   *beams);
  });
  return out;
}

ModelValue updated(const GivenLog& log, const GivenModel& model,
                   const update::FitLogOptions& options, const std::string& provenance,
                   const nb::object& progress) {
  options.check(true);
  ModelValue out;
  run_watched(progress, [&](const Hook& hook) {
    pipeline::TrainedModel known;
    if (const auto* folder = std::get_if<std::filesystem::path>(&model)) {
      known = pipeline::read_trained(*folder);
    } else {
      const ModelValue& value = *std::get<const ModelValue*>(model);
      known.model = value;
      known.training = value.training;
    }
    const std::unique_ptr<BeamSource> beams = source_of(log, known.model.all_echoes);
    WatchedSource source(*beams, hook, "fit");
    out = value_of(pipeline::update_model(std::move(known), {source, files_of(log)}, options,
                                          with_hashes(provenance), hook),
                   *beams);
  });
  return out;
}

}  // namespace

void set_fit_options(fit::FitOptions& options, const nb::dict& parameters, uint64_t seed,
                     const sensor::Sensor* sensor) {
  options.seed = seed;
  for (const auto& [key, value] : parameters) {
    set_option("fit", fit::parameters(), options, nb::cast<std::string>(key), value);
  }
  check_options("fit", fit::parameters(), options);
  if (sensor) pipeline::set_recorder(*sensor, options);
}

void bind_fit(nb::module_& m) {
  m.def(
      "fit_parameters", [] { return rows_of(fit::parameters()); },
      nb::sig("def fit_parameters() -> list[tuple[str, str, str, str, str]]"),
      "Returns the table of the parameters of a fit: name, type, default, unit and help.");
  bind_options<update::FitLogOptions>(m, "FitLogOptions", "fit_log", &update::fit_log_options);
  m.def("fitters", &fit::fitter_names, "Returns the names of the fitters.");
  m.def("fit", &fitted, "logs"_a, "parameters"_a, "seed"_a, "sensor"_a.none(), "of_log"_a,
        "provenance"_a, "progress"_a.none(), "Fits a model to a log or several.");
  m.def("update", &updated, "log"_a, "model"_a, "options"_a, "provenance"_a, "progress"_a.none(),
        "Adds a log to a model.");
}

}  // namespace underbrush::python
