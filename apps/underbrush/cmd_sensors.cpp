#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/option_table.hpp"
#include "report/sensor_plots.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/pipeline/sensor_echo.hpp"
#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/sensor/sensor.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace sensors_verb {

using sensor::Sensor;

struct Arguments {
  std::string action, name, plot, csv;
  std::vector<std::string> targets;   ///< Each is RANGE[:MATERIAL[:SHARE]], range in m.
  pipeline::SimulateOptions options;  ///< Its `visibility` and `rain` are options here, too.
};

void write_csv(const pipeline::SensorEcho& echo, const std::string& file) {
  std::string text = "range_m,signal\n";
  for (const auto& [range, signal] : echo.waveform) {
    text += fmt::format("{:.4f},{:.4f}\n", range, signal);
  }
  io::write_atomically(file, text);
}

void echo_of_sensor(const Verb& verb, const Arguments& a) {
  const Sensor s = sensor::load(a.name);
  const pipeline::InstrumentOptions& air = a.options.instrument;
  const pipeline::SensorEcho echo =
      pipeline::echo_of_targets(s, a.targets, air.visibility_m, air.rain_mm_per_h, verb.seed);
  if (!a.csv.empty()) write_csv(echo, a.csv);
  if (!a.plot.empty()) report::plot_echoes(s, echo, a.plot);
  Json j;
  j["sensor"] = s.name;
  j["extinction_per_m"] = echo.extinction_per_m;
  j["signals"] = echo.signal;
  j["echoes"] = Json::array();
  std::string table = fmt::format("{}: {} of {} targets' light, {} echoes\n", s.name, s.title,
                                  a.targets.size(), echo.echoes.count);
  for (const radiometry::Echo& e : echo.echoes) {
    j["echoes"].push_back({{"range_m", e.range_m},
                           {"intensity", e.intensity},
                           {"signal_to_noise", e.peak},
                           {"pulse_width_m", e.width_m}});
    table += fmt::format("  {:9.3f} m  intensity {:g}  signal/noise {:.1f}  pulse width {:.3f} m\n",
                         e.range_m, e.intensity, e.peak, e.width_m);
  }
  verb.report(j, table);
}

std::string returns_of(const sensor::SignalChain& c) {
  switch (c.mode) {
    case sensor::ReturnMode::kStrongest:
      return "strongest";
    case sensor::ReturnMode::kFirst:
      return "first";
    case sensor::ReturnMode::kLast:
      return "last";
    case sensor::ReturnMode::kAll:
      break;
  }
  return fmt::format("up to {}", c.max_echoes);
}

void list(const Verb& verb) {
  Json j = Json::array();
  std::string table = fmt::format("{:<20} {:<11} {:>9}  {:>5} {:>6}  {:<10} {}\n", "name", "kind",
                                  "beams/s", "rings", "max m", "returns", "title");
  for (const std::string& name : sensor::names()) {
    const Sensor s = sensor::load(name);
    table +=
        fmt::format("{:<20} {:<11} {:>9.0f}  {:>5} {:>6g}  {:<10} {}\n", name, sensor::kind_name(s),
                    s.beams_per_s(), s.rings(), s.max_range_m, returns_of(s.signal), s.title);
    j.push_back({{"name", name},
                 {"title", s.title},
                 {"kind", sensor::kind_name(s)},
                 {"beams_per_s", s.beams_per_s()},
                 {"rings", s.rings()},
                 {"max_range_m", s.max_range_m}});
  }
  verb.report(j, table);
}

Json json_of(const Sensor& s, const report::SvgPlot::Points& scan) {
  const auto by_second = [](auto& a, auto& b) { return a.second < b.second; };
  const auto [west, east] = std::minmax_element(scan.begin(), scan.end());
  const auto [low, high] = std::minmax_element(scan.begin(), scan.end(), by_second);
  const auto near = s.beam.half_width_m(10), far = s.beam.half_width_m(100);
  Json j;
  j["name"] = s.name;
  j["title"] = s.title;
  j["kind"] = sensor::kind_name(s);
  j["beams_per_s"] = s.beams_per_s();
  j["scans_per_s"] = s.rate_hz;
  j["beams_per_scan"] = s.beams_per_s() / s.rate_hz;
  j["channels"] = s.rings();
  j["azimuth_deg"] = {west->first, east->first};
  j["elevation_deg"] = {low->second, high->second};
  if (s.kind == sensor::Kind::kSpinning) j["azimuth_step_deg"] = s.azimuth_step_rad() / kDegree;
  j["range_m"] = {s.min_range_m, s.max_range_m};
  j["range_sigma_m"] = s.range_sigma_m;
  j["range_resolution_m"] = s.range_resolution_m;
  j["divergence_mrad"] = {s.beam.divergence_rad[0] * 1e3, s.beam.divergence_rad[1] * 1e3};
  j["exit_diameter_mm"] = s.beam.exit_diameter_m * 1e3;
  j["footprint_10m_mm"] = {2e3 * near[0], 2e3 * near[1]};
  j["footprint_100m_mm"] = {2e3 * far[0], 2e3 * far[1]};
  j["sub_rays"] = s.sub_rays;
  j["wavelength_nm"] = s.wavelength_m * 1e9;
  j["pulse_ns"] = s.signal.pulse_fwhm_s * 1e9;
  j["returns"] = returns_of(s.signal);
  j["detects"] = {{"reflectance", s.signal.detection_reflectance},
                  {"range_m", s.signal.detection_range_m}};
  j["sources"] = s.sources;
  return j;
}

std::string table_of(const Json& j) {
  std::string text =
      fmt::format("{}: {}\n", j["name"].get<std::string>(), j["title"].get<std::string>());
  for (const auto& [key, value] : j.items()) {
    if (key == "name" || key == "title" || key == "sources") continue;
    std::string words;
    if (value.is_array()) {
      for (const auto& v : value) {
        words += fmt::format("{}{:.5g}", words.empty() ? "" : "  ", v.get<double>());
      }
    } else if (value.is_number()) {
      words = fmt::format("{:.7g}", value.get<double>());
    } else if (value.is_object()) {
      words = fmt::format("reflectance {:g} at {:g} m", value["reflectance"].get<double>(),
                          value["range_m"].get<double>());
    } else {
      words = value.get<std::string>();
    }
    text += fmt::format("  {:<20} {}\n", key, words);
  }
  for (const auto& source : j["sources"]) text += "  - " + source.get<std::string>() + "\n";
  return text;
}

void show(const Verb& verb, const Arguments& a) {
  const Sensor s = sensor::load(a.name);
  const report::SvgPlot::Points scan = report::one_scan(s, size_t(1) << 18);
  if (!a.plot.empty()) report::plot_pattern(s, scan, a.plot);
  const Json j = json_of(s, scan);
  verb.report(j, table_of(j));
}

void run(const Verb& verb, const Arguments& a) {
  if (a.action == "list") {
    require(a.name.empty() && a.plot.empty(), "sensors list: takes no name and draws no plot");
    return list(verb);
  }
  require(!a.name.empty(), "sensors: name one, see underbrush sensors list");
  require(a.plot.empty() || a.plot.ends_with(".svg"), "sensors: --plot writes .svg files");
  if (a.action == "show") return show(verb, a);
  require(!a.targets.empty(), "sensors echo: give at least one --target");
  echo_of_sensor(verb, a);
}

}  // namespace sensors_verb
}  // namespace

void add_sensors(Program& program) {
  using namespace sensors_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Simulation", "sensors",
               "List sensors, draw their patterns, and compute their echoes of targets",
               "underbrush sensors list\n"
               "  underbrush sensors show velodyne-vlp16 --plot pattern.svg\n"
               "  underbrush sensors echo ibeo-lux-2010 --target 30:leaf:0.4 --target 32:soil:0.6 "
               "--csv waveform.csv",
               [a](const Verb& v) { run(v, *a); });
  CLI::App& app = verb->app;
  app.add_option("ACTION", a->action, "list, show or echo")
      ->required()
      ->check(CLI::IsMember({"list", "show", "echo"}));
  app.add_option("NAME", a->name, "A sensor of the catalogue, or a YAML file");
  verb->output("--plot", a->plot, "Draw the pattern (show) or the waveform (echo)")
      ->type_name("FILE.svg");
  verb->begin_group("Options of echo");
  app.add_option("--target", a->targets,
                 "A target that a share of the beam meets perpendicularly; may be repeated")
      ->type_name("RANGE[:MATERIAL[:SHARE]]")
      ->take_all();
  verb->output("--csv", a->csv, "Write the waveform to this file")->type_name("FILE");
  for (const auto& row : pipeline::simulate_options()) {
    if (row.name == "visibility" || row.name == "rain") add_option(app, row, a->options);
  }
}

}  // namespace underbrush::app
