#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "svg_plot.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/radiometry/link.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/radiometry/receiver.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/pattern.hpp"
#include "verb.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {

using sensor::Sensor;

constexpr double kDegree = M_PI / 180;
constexpr size_t kMostDots = 4000;

struct Arguments {
  std::string action, name, plot, csv;
  std::vector<std::string> targets;
  double visibility_m = 0, rain_mm_per_h = 0;
};

std::string kind_of(const Sensor& s) {
  switch (s.kind) {
    case sensor::Kind::kSpinning:
      return "spinning";
    case sensor::Kind::kRaster:
      return "raster";
    case sensor::Kind::kSequence:
      break;
  }
  return s.channels.empty() ? "directions" : "sweep";
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

/// A scan as seen by the sensor itself: azimuth and elevation in degrees.
SvgPlot::Points one_scan(const Sensor& s, size_t most) {
  const Trajectory still({{0, Pose{}}});
  sensor::PatternSource source(s, still, 0, 1 / s.rate_hz, most);
  BeamLog log;
  source.next(log);
  SvgPlot::Points points;
  for (const Vec3f& d : log.direction) {
    const double z = std::clamp(double(d.z()), -1.0, 1.0);
    points.emplace_back(std::atan2(double(d.y()), double(d.x())) / kDegree, std::asin(z) / kDegree);
  }
  return points;
}

void list(const Verb& verb) {
  Json j = Json::array();
  std::string table = fmt::format("{:<20} {:<11} {:>9}  {:>5} {:>6}  {:<10} {}\n", "name", "kind",
                                  "beams/s", "rings", "max m", "returns", "title");
  for (const std::string& name : sensor::names()) {
    const Sensor s = sensor::load(name);
    const size_t rings =
        s.kind == sensor::Kind::kRaster ? s.raster.rows : std::max<size_t>(1, s.channels.size());
    table += fmt::format("{:<20} {:<11} {:>9.0f}  {:>5} {:>6g}  {:<10} {}\n", name, kind_of(s),
                         s.beams_per_s(), rings, s.max_range_m, returns_of(s.signal), s.title);
    j.push_back({{"name", name},
                 {"title", s.title},
                 {"kind", kind_of(s)},
                 {"beams_per_s", s.beams_per_s()},
                 {"rings", rings},
                 {"max_range_m", s.max_range_m}});
  }
  verb.report(j, table);
}

Json json_of(const Sensor& s, const SvgPlot::Points& scan) {
  const auto by_second = [](auto& a, auto& b) { return a.second < b.second; };
  const auto [west, east] = std::minmax_element(scan.begin(), scan.end());
  const auto [low, high] = std::minmax_element(scan.begin(), scan.end(), by_second);
  const auto near = s.beam.half_width_m(10), far = s.beam.half_width_m(100);
  Json j;
  j["name"] = s.name;
  j["title"] = s.title;
  j["kind"] = kind_of(s);
  j["beams_per_s"] = s.beams_per_s();
  j["scans_per_s"] = s.rate_hz;
  j["beams_per_scan"] = s.beams_per_s() / s.rate_hz;
  j["channels"] = s.channels.size();
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

/// Of a large scan only the part around straight ahead is drawn, so that single beams can be told.
void plot_pattern(const Sensor& s, SvgPlot::Points scan, const std::string& file) {
  double half = 180;
  const auto inside = [&](const auto& p) { return std::abs(p.first) <= half; };
  while (half > 2 && size_t(std::count_if(scan.begin(), scan.end(), inside)) > kMostDots)
    half *= 0.8;
  std::erase_if(scan, [&](const auto& p) { return !inside(p); });
  double west = 1, low = 1, high = -1;
  for (const auto& [azimuth, elevation] : scan) {
    west = std::max(west, std::abs(azimuth));
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  SvgPlot plot(fmt::format("{}: one scan{}", s.title,
                           half < 180 ? fmt::format(", ±{:.0f}° ahead", half) : ""),
               "azimuth (degrees, left is positive)", "elevation (degrees)");
  plot.x_axis(1.02 * west, -1.02 * west);
  plot.y_axis(low - 0.05 * (high - low) - 0.1, high + 0.05 * (high - low) + 0.1);
  plot.dots(scan, "#1f6f4a", 2);
  plot.write(file);
}

void show(const Verb& verb, const Arguments& a) {
  const Sensor s = sensor::load(a.name);
  const SvgPlot::Points scan = one_scan(s, size_t(1) << 18);
  if (!a.plot.empty()) plot_pattern(s, scan, a.plot);
  const Json j = json_of(s, scan);
  verb.report(j, table_of(j));
}

/// RANGE[:MATERIAL[:SHARE]].
struct Target {
  float range_m = 0, share = 0, factor = 0;
};

std::vector<Target> targets_of(const Arguments& a, const Sensor& s) {
  const radiometry::Materials materials = radiometry::load_materials();
  std::vector<Target> targets;
  for (const std::string& word : a.targets) {
    const size_t first = word.find(':'),
                 second = word.find(':', std::min(first, word.size() - 1) + 1);
    const auto range = io::number_of(word.substr(0, first));
    const bool shared = first != std::string::npos && second != std::string::npos;
    const auto share =
        shared ? io::number_of(word.substr(second + 1)) : 1.0 / double(a.targets.size());
    require(
        range && share && *range > 0 && *share > 0 && *share <= 1,
        "sensors echo: a target is RANGE, RANGE:MATERIAL or RANGE:MATERIAL:SHARE, shares 0 to 1");
    const std::string name = first == std::string::npos
                                 ? "grey_target"
                                 : word.substr(first + 1, shared ? second - first - 1 : second);
    const radiometry::Material& m = materials.named(name);
    targets.push_back(
        {float(*range), float(*share),
         float(m.reflectance_at(s.wavelength_m) * radiometry::backscatter(m.surface, 1))});
  }
  return targets;
}

void write_csv(const radiometry::Waveform& waveform, const std::string& file) {
  std::string text = "range_m,signal\n";
  for (const auto& [range, signal] : radiometry::table_of(waveform)) {
    text += fmt::format("{:.4f},{:.4f}\n", range, signal);
  }
  io::write_atomically(file, text);
}

void plot_waveform(const Sensor& s, const radiometry::Waveform& waveform,
                   const radiometry::Echoes& echoes, const std::string& file) {
  SvgPlot::Points points;
  double top = 2 * s.signal.threshold_snr;
  for (const auto& [range, signal] : radiometry::table_of(waveform)) {
    if (!points.empty() && range - points.back().first > 1.5 * waveform.cell_m()) {
      points.emplace_back(range, NAN);
    }
    points.emplace_back(range, signal);
    top = std::max(top, signal);
  }
  SvgPlot plot(s.title + ": received signal", "range (m)", "signal / noise");
  const double from = points.empty() ? 0 : points.front().first - 1;
  const double to = points.empty() ? s.max_range_m : points.back().first + 1;
  plot.x_axis(from, to);
  plot.y_axis(-0.1 * top, 1.1 * top);
  plot.line(points, "#1f6f4a");
  plot.line({{from, s.signal.threshold_snr}, {to, s.signal.threshold_snr}}, "#b03030", true);
  for (const radiometry::Echo& e : echoes) {
    plot.line({{e.range_m, 0}, {e.range_m, e.peak}}, "#2050a0", true);
    plot.text(e.range_m, 1.03 * double(e.peak), fmt::format("{:.3f} m", e.range_m));
  }
  plot.write(file);
}

void echo(const Verb& verb, const Arguments& a) {
  const Sensor s = sensor::load(a.name);
  double air = radiometry::rain_extinction_per_m(a.rain_mm_per_h);
  if (a.visibility_m > 0) air += radiometry::fog_extinction_per_m(a.visibility_m, s.wavelength_m);
  const radiometry::Receiver receiver(radiometry::receiver_options(s, air));
  radiometry::Waveform waveform = receiver.scratch();
  std::vector<float> range, weight, factor;
  for (const Target& t : targets_of(a, s)) {
    range.push_back(t.range_m);
    weight.push_back(t.share);
    factor.push_back(t.factor);
  }
  std::vector<float> signal(range.size());
  const radiometry::Echoes echoes =
      receiver.receive(range, weight, factor, signal, beam_key(verb.seed, 0, 0), waveform);
  if (!a.csv.empty()) write_csv(waveform, a.csv);
  if (!a.plot.empty()) plot_waveform(s, waveform, echoes, a.plot);
  Json j;
  j["sensor"] = s.name;
  j["extinction_per_m"] = air;
  j["signals"] = signal;
  j["echoes"] = Json::array();
  std::string table = fmt::format("{}: {} of {} targets' light, {} echoes\n", s.name, s.title,
                                  range.size(), echoes.count);
  for (const radiometry::Echo& e : echoes) {
    j["echoes"].push_back({{"range_m", e.range_m},
                           {"intensity", e.intensity},
                           {"signal_to_noise", e.peak},
                           {"pulse_width_m", e.width_m}});
    table += fmt::format("  {:9.3f} m  intensity {:g}  signal/noise {:.1f}  pulse width {:.3f} m\n",
                         e.range_m, e.intensity, e.peak, e.width_m);
  }
  verb.report(j, table);
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
  echo(verb, a);
}

}  // namespace

void add_sensors(CLI::App& root) {
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      root, "sensors", "The catalogue of sensors, their patterns, and what they make of targets",
      "underbrush sensors list\n"
      "  underbrush sensors show velodyne-vlp16 --plot pattern.svg\n"
      "  underbrush sensors echo ibeo-lux-2010 --target 30:leaf:0.4 --target 32:soil:0.6 "
      "--csv waveform.csv",
      [a](const Verb& v) { run(v, *a); });
  CLI::App& app = *verb->app;
  app.add_option("ACTION", a->action, "list, show or echo")
      ->required()
      ->check(CLI::IsMember({"list", "show", "echo"}));
  app.add_option("NAME", a->name, "A sensor of the catalogue, or a YAML file");
  app.add_option("--plot", a->plot, "Draw the pattern (show) or the waveform (echo)")
      ->type_name("FILE.svg");
  app.add_option("--target", a->targets,
                 "echo: what part of the beam meets, perpendicularly; may be repeated")
      ->type_name("RANGE[:MATERIAL[:SHARE]]")
      ->take_all();
  app.add_option("--csv", a->csv, "echo: write the waveform")->type_name("FILE");
  app.add_option("--visibility", a->visibility_m, "echo: in haze or fog, m, 0 = clear air")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--rain", a->rain_mm_per_h, "echo: in rain, mm/h")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

}  // namespace underbrush::app
