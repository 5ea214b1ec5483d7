// The program underbrush-reference PAGE prints the pages of the reference that are generated from
// the program's tables, and its manual page. It belongs to the build of the documentation and is
// not installed.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>

#include "cli/reference.hpp"
#include "underbrush/fit/fitters.hpp"
#include "underbrush/fit/parameters.hpp"
#include "underbrush/osi/strategy.hpp"
#include "underbrush/perception/perceive_options.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

std::string fitters_table() {
  std::string out = "| fitter | what it makes |\n|---|---|\n";
  for (const fit::Fitter& f : fit::fitters()) {
    out += fmt::format("| `{}` | {} |\n", f.name, f.summary);
  }
  return out;
}

/// Returns a range such as "0.005 to 0.5, logarithmic", or nothing.
std::string range_of(const fit::Parameter& p) {
  if (!p.tuning) return "";
  const char* scale = p.tuning->scale == fit::Scale::kLinear ? "linear"
                      : p.tuning->scale == fit::Scale::kLog  ? "logarithmic"
                                                             : "whole numbers";
  return fmt::format("{:g} to {:g}, {}{}", p.tuning->low, p.tuning->high, scale,
                     p.tuning->usual ? "" : "; if named");
}

std::string parameters_page() {
  std::string out =
      "# Parameters of a fit\n\nThis page is made from the table that the command line, "
      "configurations and `optimize` share.\nA parameter is the option `--NAME` of `fit` and the "
      "key `NAME` of a configuration. A range is where\n`optimize` looks for the best value; it "
      "takes parameters marked *if named* only with `--tune`.\n\n" +
      fitters_table();
  const fit::FitOptions defaults;
  for (const std::string_view group : fit::group::kAll) {
    out += fmt::format(
        "\n## {}\n\n| name | unit | default | what it does | range of tuning |\n"
        "|---|---|---|---|---|\n",
        group);
    for (const fit::Parameter& p : fit::parameters()) {
      if (p.group != group) continue;
      const std::string choices =
          p.choices.empty() ? "" : fmt::format("; one of {}", fmt::join(p.choices, ", "));
      out += fmt::format("| `{}` | {} | {} | {}{} | {} |\n", p.name, p.unit, text_of(p, defaults),
                         p.help, choices, range_of(p));
    }
  }
  return out;
}

std::string sensors_page() {
  std::string out =
      "# Sensor catalogue\n\nThis page is made from the files of `share/sensors`, which are built "
      "into the program.\n`underbrush sensors show NAME` prints one. [Sensor "
      "files](sensor-files.md) has the keys.\n\n| name | maker and model | kind | rings | ring 0 | "
      "beams/s | range, m | "
      "divergence, mrad | σ of the range, m |\n|---|---|---|---:|---|---:|---|---|---:|\n";
  for (const std::string& name : sensor::names()) {
    const sensor::Sensor s = sensor::load(name);
    const char* first = s.channels.size() < 2 ? "–"
                        : s.channels.front().elevation_rad < s.channels.back().elevation_rad
                            ? "lowest"
                            : "highest";
    out += fmt::format(
        "| `{}` | {} | {} | {} | {} | {:.0f} | {:g} to {:g} | {:.3g} × {:.3g} | {:g} |\n", name,
        s.title, sensor::kind_name(s), s.rings(), first, s.beams_per_s(), s.min_range_m,
        s.max_range_m, 1e3 * s.beam.divergence_rad[0], 1e3 * s.beam.divergence_rad[1],
        s.range_sigma_m);
  }
  return out;
}

std::string materials_page() {
  const radiometry::Materials all = radiometry::load_materials();
  std::string out =
      "# Materials\n\nThis page is made from `share/materials/materials.yaml`, which is built into "
      "the "
      "program.\n[From light to echoes](../explanation/radiometry.md#materials) has the keys of a "
      "table "
      "of your own.\n\n| material | reflectance at 532 | 850 | 905 | 1064 | 1550 nm |\n"
      "|---|---:|---:|---:|---:|---:|\n";
  for (const radiometry::Material& m : all.material) {
    out += fmt::format("| `{}` |", m.name);
    for (const double nm : {532, 850, 905, 1064, 1550}) {
      out += fmt::format(" {:.2f} |", m.reflectance_at(nm * 1e-9));
    }
    out += "\n";
  }
  out += "\n| class | material |\n|---|---|\n";
  for (const auto& [label, material] : all.of_class) {
    out += fmt::format("| `{}` | `{}` |\n", label, material);
  }
  return out;
}

/// What the option of `perceive` does whose name a parameter has, without its unit.
std::string_view help_of_perceive(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  for (const auto& row : perception::perceive_options()) {
    if (key == row.name || key == fmt::format("{}-{}", row.name, row.unit)) return row.help;
  }
  return "";
}

std::string strategies_page() {
  std::string out =
      "# Parameters of strategies\n\nThis page is made from the program's tables; [OSI](osi.md) "
      "describes the strategies. A parameter is a key of a\nstrategy's entry in a chain.\n";
  for (const std::string& strategy : osi::strategy_names()) {
    const bool perceives = strategy == "tracking" || strategy == "grid";
    out += fmt::format("\n## {}\n\n| parameter | default | values |{}\n|---|---|---|{}\n", strategy,
                       perceives ? " as in `perceive` |" : "", perceives ? "---|" : "");
    for (const osi::StrategyParameter& p : osi::parameters_of(strategy)) {
      out += fmt::format("| `{}` | {} | {} |", p.key, p.fallback, p.values);
      out += perceives ? fmt::format(" {} |\n", help_of_perceive(p.key)) : "\n";
    }
  }
  return out;
}

}  // namespace
}  // namespace underbrush::app

int main(int argc, char** argv) {
  using namespace underbrush;
  app::Program program("underbrush", app::kSummary);
  app::add_all_verbs(program);
  const std::map<std::string, std::function<std::string()>> pages = {
      {"command-line", [&] { return app::command_line_page(program.app()); }},
      {"man", [&] { return app::manual_page(program.app(), app::version()); }},
      {"materials", app::materials_page},
      {"parameters", app::parameters_page},
      {"sensor-catalogue", app::sensors_page},
      {"strategies", app::strategies_page},
  };
  const auto page = pages.find(argc == 2 ? argv[1] : "");
  if (page == pages.end()) {
    std::cerr << "usage: underbrush-reference PAGE, one of:";
    for (const auto& [name, text] : pages) std::cerr << " " << name;
    std::cerr << "\n";
    return 2;
  }
  std::cout << page->second();
  return 0;
}
