#include "instrument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "report/svg_plot.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/radiometry/link_budget.hpp"

namespace underbrush::app {
namespace {

constexpr size_t kMostPlotted = 12;

/// Parses a whole number from 1 to `most`.
int whole(std::string_view word, int most) {
  const auto n = io::number_of(word);
  require(n && *n == std::floor(*n) && *n >= 1 && *n <= most,
          "simulate: --super-sample takes N, COLUMNSxROWS or sensor");
  return int(*n);
}

std::vector<sensor::SubRay> sub_rays_of(const std::string& word, const sensor::Sensor& s) {
  if (word == "sensor") return sensor::grid_sub_rays(s.beam, s.sub_rays[0], s.sub_rays[1]);
  const size_t cross = word.find('x');
  if (cross == std::string::npos) return sensor::spread_sub_rays(s.beam, whole(word, 1 << 14));
  return sensor::grid_sub_rays(s.beam, whole(std::string_view(word).substr(0, cross), 128),
                               whole(std::string_view(word).substr(cross + 1), 128));
}

void set_returns(const std::string& word, radiometry::ReceiverOptions& o) {
  using radiometry::ReturnMode;
  if (word.empty()) return;
  o.max_echoes = 1;
  if (word == "strongest") {
    o.mode = ReturnMode::kStrongest;
  } else if (word == "first") {
    o.mode = ReturnMode::kFirst;
  } else if (word == "last") {
    o.mode = ReturnMode::kLast;
  } else {
    const auto n = io::number_of(word);
    require(n && *n == std::floor(*n) && *n >= 1 && *n <= radiometry::Echoes::kMost,
            "simulate: --returns takes strongest, first, last or a number of 1 to 16");
    o.mode = ReturnMode::kAll;
    o.max_echoes = int(*n);
  }
}

/// Returns the variance that sunlight from a white scene adds to the noise of a receiver that sees
/// the beam's divergence.
double sunlit_variance(const sensor::Sensor& s, double share) {
  if (share == 0) return 0;
  radiometry::LinkBudget link;
  if (s.wavelength_m > 0) link.wavelength_m = s.wavelength_m;
  const double view = std::max(s.beam.divergence_rad[0], s.beam.divergence_rad[1]);
  if (view > 0) link.view_rad = view;
  const double noise =
      radiometry::noise_in_light(link, radiometry::solar_background_w(link, 1, share));
  return noise * noise - 1;
}

void write_csv(const std::string& file, const std::vector<simulate::BeamWaveform>& waveforms) {
  io::write_atomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << kWaveformColumns << "\n";
    for (const simulate::BeamWaveform& w : waveforms) {
      for (const auto& [range, signal] : w.signal) {
        out << fmt::format("{},{},{},{:.9f},{:.4f},{:.4f}\n", w.beam, w.scan, w.ring, w.time_s,
                           range, signal);
      }
    }
    if (!out.flush()) throw IoError(file + ": cannot write");
  });
}

/// Draws one waveform above the other, each scaled to its own peak (but at least twice the
/// threshold).
void plot(const std::string& file, const sensor::Sensor& s,
          const std::vector<simulate::BeamWaveform>& waveforms) {
  std::vector<const simulate::BeamWaveform*> shown;
  for (const auto& w : waveforms) {
    if (!w.signal.empty() && shown.size() < kMostPlotted) shown.push_back(&w);
  }
  double from = INFINITY, to = -INFINITY;
  for (const auto* w : shown) {
    from = std::min(from, w->signal.front().first);
    to = std::max(to, w->signal.back().first);
  }
  if (shown.empty()) from = 0, to = s.max_range_m;
  report::SvgPlot out(fmt::format("{}: {} waveforms", s.title, shown.size()), "range (m)",
                      "signal, each to its own scale");
  // Labels stand to the left of all signals.
  const double label_m = 0.1 * (to - from) + 0.5;
  out.x_axis(from - label_m, to + 0.5);
  out.y_axis(-0.2, std::max<double>(1, double(shown.size())));
  for (size_t k = 0; k < shown.size(); ++k) {
    const double base = double(shown.size() - 1 - k);
    double top = 2 * s.signal.threshold_snr, before = NAN;
    for (const auto& [range, signal] : shown[k]->signal) top = std::max(top, signal);
    report::SvgPlot::Points points;
    for (const auto& [range, signal] : shown[k]->signal) {
      if (range - before > 2) points.emplace_back(range, NAN);
      points.emplace_back(range, base + 0.85 * signal / top);
      before = range;
    }
    out.line(points, "#1f6f4a");
    const double level = base + 0.85 * s.signal.threshold_snr / top;
    out.line({{from, level}, {to, level}}, "#b03030", true);
    for (const double r : shown[k]->echo_m)
      out.line({{r, base}, {r, base + 0.85}}, "#2050a0", true);
    out.text(from - 0.95 * label_m, base + 0.3, fmt::format("beam {}", shown[k]->beam));
  }
  out.write(file);
}

}  // namespace

void InstrumentArguments::check() const {
  const bool light = !returns.empty() || !materials.empty() || !material.empty() ||
                     visibility_m > 0 || rain_mm_per_h > 0 || sun > 0 || !waveforms.empty();
  require(!super_sample.empty() || !light,
          "simulate: returns, materials, air, sun and waveforms need --super-sample");
  for (const std::string& file : waveforms) {
    require(file.ends_with(".csv") || file.ends_with(".svg") || is_waveform_file(file),
            "simulate: --waveforms writes .csv, .svg and .waves files");
    io::check_output(file);
  }
}

void add_instrument_options(Verb& verb, InstrumentArguments& a) {
  CLI::App& app = verb.app;
  verb.begin_group("Instrument");
  app.add_option("--super-sample", a.super_sample,
                 "Trace sub-rays over the sensor's beam, with light, waveforms and echoes: a "
                 "number, COLUMNSxROWS, or sensor for what its data file says")
      ->type_name("N|NxM|sensor");
  app.add_option(
         "--returns", a.returns,
         "Echoes to report: strongest, first, last or up to N (default: as the sensor does)")
      ->type_name("MODE|N");
  verb.output("--waveforms", a.waveforms,
              "Write digitised waveforms as a table or a plot, or those of all beams as .waves; "
              "may be repeated")
      ->type_name("FILE")
      ->take_all();
  verb.begin_rare_group("Sub-rays");
  app.add_flag("--all-sub-rays", a.all_sub_rays,
               "Trace all sub-rays of every beam, also where 13 of 26 or more agree");
  app.add_option(
         "--footprint", a.footprint,
         "Spread sub-rays by what the beam is wider than that of the log that the model was "
         "fitted to, whose footprint is in the model, or by the whole beam")
      ->check(CLI::IsMember({"excess", "whole"}))
      ->capture_default_str();
  verb.begin_rare_group("Light and air");
  app.add_option("--materials", a.materials, "Table of materials that replaces the built-in one")
      ->type_name("FILE.yaml");
  app.add_option("--material", a.material, "Material of a class; may be repeated")
      ->type_name("CLASS=MATERIAL")
      ->take_all();
  app.add_option("--visibility", a.visibility_m, "Visibility in haze or fog, m; 0 = clear air")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--rain", a.rain_mm_per_h, "Rain rate, mm/h")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--sun", a.sun,
                 "Share of the sunlight that passes the air, which raises the noise; 0 = night")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.begin_rare_group("Waveforms");
  app.add_option("--waveform-every", a.waveform.every, "Write the waveforms of beams 0, K, 2K, …")
      ->check(CLI::PositiveNumber)
      ->type_name("K")
      ->capture_default_str();
  app.add_option("--waveform-count", a.waveform.count,
                 "Largest number of waveforms in tables and plots")
      ->check(CLI::Range(size_t(1), size_t(1000000)))
      ->type_name("N")
      ->capture_default_str();
}

std::optional<sensor::Sensor> recorder_of(std::span<const elements::Model> models) {
  constexpr double kTypicalRange = 20;  // m; where the widths of several beams are compared
  const auto has_volumes = [](const elements::Model& m) { return !m.ellipsoids.empty(); };
  const bool volumes = std::any_of(models.begin(), models.end(), has_volumes);
  std::optional<sensor::Sensor> narrowest;
  for (const elements::Model& m : models) {
    if (m.size() == 0 || (volumes && !has_volumes(m))) continue;
    if (m.sensor.empty() || m.all_echoes) return std::nullopt;
    LogInfo info;
    info.sensor = m.sensor;
    info.sensor_file = m.sensor_file;
    sensor::Sensor s = sensor::sensor_of_log("model", info);
    s.range_sigma_m = std::min(s.range_sigma_m, m.range_noise_m);
    s.max_range_m = std::min(s.max_range_m, m.max_range_m);
    if (!narrowest || s.beam.sigma_m(kTypicalRange) < narrowest->beam.sigma_m(kTypicalRange)) {
      narrowest = std::move(s);
    }
  }
  return narrowest;
}

simulate::Instrument instrument_of(const InstrumentArguments& a, sensor::Sensor s,
                                   const std::optional<sensor::Sensor>& recorder) {
  double air = radiometry::rain_extinction_per_m(a.rain_mm_per_h);
  if (a.visibility_m > 0) air += radiometry::fog_extinction_per_m(a.visibility_m, s.wavelength_m);
  const double sunlit = sunlit_variance(s, a.sun);
  simulate::Instrument instrument;
  instrument.sub_rays = sub_rays_of(a.super_sample, s);
  if (recorder && a.footprint == "excess") {
    s.beam = sensor::wider_by(s.beam, recorder->beam);
    const bool thin =
        s.beam.exit_diameter_m == 0 && s.beam.divergence_rad == std::array<double, 2>{0, 0};
    if (thin) instrument.sub_rays = {{}};
  }
  if (recorder && recorder->name == s.name) {
    s.range_sigma_m = recorder->range_sigma_m;
    s.max_range_m = recorder->max_range_m;
  }
  instrument.beam = s.beam;
  instrument.receiver = radiometry::receiver_options(s, air, sunlit);
  set_returns(a.returns, instrument.receiver);
  return instrument;
}

radiometry::Materials materials_of(const InstrumentArguments& a,
                                   const simulate::InstanceKinds& kinds) {
  radiometry::Materials m = simulate::with_own_materials(radiometry::load_materials(a.materials),
                                                         kinds, a.materials.empty());
  const auto is_class = [&](const std::string& name) {
    return elements::class_from_name(name) ||
           std::find(kinds.class_names.begin(), kinds.class_names.end(), name) !=
               kinds.class_names.end();
  };
  for (const std::string& word : a.material) {
    const size_t equals = word.find('=');
    require(equals != std::string::npos && is_class(word.substr(0, equals)),
            "simulate: --material takes CLASS=MATERIAL with a class that `info` names");
    const std::string label = word.substr(0, equals), name = word.substr(equals + 1);
    m.named(name);  // This throws for an unknown name.
    std::erase_if(m.of_class, [&](const auto& entry) { return entry.first == label; });
    m.of_class.emplace_back(label, name);
  }
  return m;
}

bool is_waveform_file(const std::string& file) { return file.ends_with(".waves"); }

void write_waveforms(const InstrumentArguments& a, const sensor::Sensor& sensor,
                     const std::vector<simulate::BeamWaveform>& waveforms) {
  for (const std::string& file : a.waveforms) {
    if (is_waveform_file(file)) continue;
    file.ends_with(".csv") ? write_csv(file, waveforms) : plot(file, sensor, waveforms);
  }
}

}  // namespace underbrush::app
