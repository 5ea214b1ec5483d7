#include "fit_options.hpp"

#include <set>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/pipeline/fit_model.hpp"

namespace underbrush::app {
namespace {

/// Returns "", or what is wrong with `start` as the model from which `likelihood` starts.
std::string wrong_start(const std::string& start) {
  if (!elements::is_scene(start)) return {};
  return "likelihood refines a model, but " + start + " is a scene";
}

std::string help_of(const fit::Parameter& p) {
  return std::string(p.help) + (p.unit.empty() ? "" : ", " + std::string(p.unit));
}

CLI::Option* add_option(CLI::App& app, const fit::Parameter& p, fit::FitOptions& fit) {
  const std::string name = "--" + std::string(p.name), help = help_of(p);
  CLI::Option* option = std::visit(
      [&](const auto field) -> CLI::Option* {
        auto& place = field(fit);
        if constexpr (std::is_same_v<decltype(place), bool&>) {
          return app.add_flag(name, place, help);
        } else {
          return app.add_option(name, place, help)->capture_default_str();
        }
      },
      p.field);
  if (p.choices) option->check(CLI::IsMember(p.choices()));
  if (p.name == "start") option->check(wrong_start);
  return option;
}

CLI::Option* add_sensor_option(CLI::App& app, fit::FitOptions& fit) {
  return app
      .add_option_function<std::string>(
          "--sensor",
          [&fit](const std::string& name) { pipeline::set_recorder(sensor::load(name), fit); },
          "The sensor that recorded the log; hierarchical removes its footprint from ellipsoids")
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
    if (is_usual(p)) out.push_back(add_option(verb.app, p, fit));
  }
  if (help == kAllRare) verb.begin_rare_group("fit: every fitter");
  out.push_back(add_sensor_option(verb.app, fit));
  for (const fit::Parameter& p : fit::parameters()) {
    if (is_usual(p)) continue;
    verb.begin_rare_group("fit: " + std::string(fit::name_of(p.group)));
    CLI::Option* option = add_option(verb.app, p, fit);
    if (p.listed == fit::Listed::kReference) option->group(kUnlistedGroup);
    out.push_back(option);
  }
  verb.begin_group("Options");
  return out;
}

}  // namespace underbrush::app
