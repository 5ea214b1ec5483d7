#include "fit_options.hpp"

#include "cli/option_table.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::app {
namespace {

CLI::Option* add_sensor_option(CLI::App& app, fit::FitOptions& fit) {
  return app
      .add_option_function<std::string>(
          "--sensor",
          [&fit](const std::string& name) { pipeline::set_recorder(sensor::load(name), fit); },
          "The sensor of the log, if the log does not name it; hierarchical and likelihood remove "
          "its footprint")
      ->type_name("SENSOR");
}

}  // namespace

std::vector<const CLI::Option*> add_fit_options(Verb& verb, fit::FitOptions& fit, FitHelp help) {
  std::vector<const CLI::Option*> out;
  verb.begin_group("Options");
  const auto is_usual = [&](const fit::Parameter& p) {
    return help == kUsualShown && p.listed == fit::Listed::kHelp;
  };
  for (const fit::Parameter& p : fit::parameters()) {
    if (is_usual(p)) out.push_back(add_option<fit::FitOptions>(verb.app, p, fit));
  }
  if (help == kAllRare) verb.begin_rare_group("fit: every fitter");
  out.push_back(add_sensor_option(verb.app, fit));
  for (const fit::Parameter& p : fit::parameters()) {
    if (is_usual(p)) continue;
    verb.begin_rare_group("fit: " + std::string(p.group));
    CLI::Option* option = add_option<fit::FitOptions>(verb.app, p, fit);
    if (p.listed == fit::Listed::kReference) option->group(kUnlistedGroup);
    out.push_back(option);
  }
  verb.begin_group("Options");
  return out;
}

}  // namespace underbrush::app
