/// \file
/// The verb `fit`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <chrono>

#include "bind.hpp"
#include "fit_json.hpp"
#include "fit_options.hpp"
#include "fit_parameters.hpp"
#include "given.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/json_text.inl"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

/// Sets a parameter from a Python value.
void set(const fit::Parameter& p, fit::FitOptions& options, nb::handle value) {
  std::visit(
      [&](const auto field) {
        auto& place = field(options);
        try {
          place = nb::cast<std::decay_t<decltype(place)>>(value);
        } catch (const nb::cast_error&) {
          throw nb::type_error(("fit: " + std::string(p.name) + " cannot be " +
                                nb::cast<std::string>(nb::repr(value)))
                                   .c_str());
        }
      },
      p.field);
  if (!p.choices) return;
  const std::vector<std::string> choices = p.choices();
  const std::string text = p.text(options);
  if (std::find(choices.begin(), choices.end(), text) != choices.end()) return;
  std::string all;
  for (const std::string& c : choices) all += (all.empty() ? "" : ", ") + c;
  throw std::invalid_argument("fit: " + std::string(p.name) + " is one of " + all + ", not " +
                              text);
}

/// Returns the rows of the table of parameters: name, type, default, unit, help.
nb::list parameter_table() {
  nb::list out;
  fit::FitOptions defaults;
  for (const fit::Parameter& p : fit::parameters()) {
    const char* type = std::visit(
        [](const auto field) {
          using T = std::decay_t<decltype(field(std::declval<fit::FitOptions&>()))>;
          return std::is_same_v<T, bool>          ? "bool"
                 : std::is_same_v<T, std::string> ? "str"
                 : std::is_same_v<T, double>      ? "float"
                                                  : "int";
        },
        p.field);
    const auto text = [](std::string_view s) { return nb::str(s.data(), s.size()); };
    out.append(nb::make_tuple(text(p.name), type, p.text(defaults), text(p.unit), text(p.help)));
  }
  return out;
}

ModelValue fitted(const GivenLog& log, const nb::dict& parameters, uint64_t seed,
                  const sensor::Sensor* sensor, const std::string& provenance,
                  const nb::object& progress) {
  fit::FitOptions options;
  set_fit_options(options, parameters, seed, sensor);
  app::FitStep step;
  run_watched(progress, [&](const Hook& hook) {
    const auto start = std::chrono::steady_clock::now();
    const std::unique_ptr<BeamSource> beams = source_of(log);
    WatchedSource source(*beams, hook, "fit");
    try {
      step.result = fit::fit(source, options, hook);
      step.skipped = skipped_in(*beams);
    } catch (const DataError& e) {
      if (!std::holds_alternative<std::filesystem::path>(log)) throw;
      throw FormatError(name_of(log), "", e.what());
    }
    step.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  });
  app::Json origin = io::json_of_text(provenance);
  if (!step.result.report.likelihood.steps.empty())
    origin["likelihood"] = app::json_of(step.result.report.likelihood);
  ModelValue out;
  out.report = app::json_of(step).dump();
  static_cast<elements::Model&>(out) = std::move(step.result.model);
  out.provenance = io::text_of_json(origin);
  return out;
}

}  // namespace

void set_fit_options(fit::FitOptions& options, const nb::dict& parameters, uint64_t seed,
                     const sensor::Sensor* sensor) {
  options.seed = seed;
  for (const auto& [key, value] : parameters) {
    std::string name = nb::cast<std::string>(key);
    std::replace(name.begin(), name.end(), '_', '-');
    std::vector<std::string> names;
    bool found = false;
    for (const fit::Parameter& p : fit::parameters()) {
      names.emplace_back(p.name);
      if (p.name != name) continue;
      set(p, options, value);
      found = true;
    }
    if (found) continue;
    std::string near = nearest_name(name, names);
    std::replace(near.begin(), near.end(), '-', '_');
    throw nb::type_error(("fit: no parameter '" + nb::cast<std::string>(key) + "'" +
                          (near.empty() ? "" : "; did you mean '" + near + "'?"))
                             .c_str());
  }
  require(!elements::is_scene(options.start),
          "fit: likelihood refines a model, but start is a scene");
  if (sensor) app::set_recorder(*sensor, options);
}

void bind_fit(nb::module_& m) {
  m.def("fit_parameters", &parameter_table,
        nb::sig("def fit_parameters() -> list[tuple[str, str, str, str, str]]"),
        "Returns the table of the parameters of a fit: name, type, default, unit and help.");
  m.def("fitters", &fit::fitter_names, "Returns the names of the fitters.");
  m.def("fit", &fitted, "log"_a, "parameters"_a, "seed"_a, "sensor"_a.none(), "provenance"_a,
        "progress"_a.none(), "Fits a model to a log.");
}

}  // namespace underbrush::python
